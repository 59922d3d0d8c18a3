// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace coslam {

// Table from ids to objects, for ids that are given in ascending order, so that most live ones are near each other. A
// lookup reads two arrays; blocks without live ids are freed.
template <class Id, class T>
class IdTable {
 public:
  T* find(Id id) const {
    const std::size_t block = id.value / kInBlock;
    if (block >= blocks_.size() || !blocks_[block]) return nullptr;
    return blocks_[block]->entries[id.value % kInBlock];
  }

  void put(Id id, T& value) {
    const std::size_t block = id.value / kInBlock;
    if (block >= blocks_.size()) blocks_.resize(block + 1);
    if (!blocks_[block]) blocks_[block] = std::make_unique<Block>();
    T*& at = blocks_[block]->entries[id.value % kInBlock];
    if (at == nullptr) ++blocks_[block]->size;
    at = &value;
  }

  void erase(Id id) {
    if (find(id) == nullptr) return;
    std::unique_ptr<Block>& block = blocks_[id.value / kInBlock];
    block->entries[id.value % kInBlock] = nullptr;
    if (--block->size == 0) block.reset();
  }

  std::size_t bytes() const {
    std::size_t blocks = 0;
    for (const auto& b : blocks_) blocks += b ? 1 : 0;
    return blocks_.capacity() * sizeof blocks_[0] + blocks * sizeof(Block);
  }

 private:
  static constexpr std::size_t kInBlock = 128;
  struct Block {
    std::array<T*, kInBlock> entries{};
    std::size_t size = 0;
  };
  std::vector<std::unique_ptr<Block>> blocks_;
};

}  // namespace coslam
