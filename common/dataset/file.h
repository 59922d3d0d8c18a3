// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace coslam {

// Opens a file for writing, its folders created. Throws UserError.
std::ofstream create_file(const std::filesystem::path& file, std::ios::openmode mode = std::ios::out);
// Throws UserError when something written to the file did not get there.
void close_file(std::ofstream& stream, const std::filesystem::path& file);

// The end of a warning about an OutputFile: what becomes of its data.
std::string what_becomes_of(bool ended);

// A file of a result while it is written, buffered. Each write() gets there whole or not at all. What a full disk does
// not take is kept, up to 16 MiB, and tried again each second; a disk that stays full ends the file with a whole
// write().
class OutputFile {
 public:
  enum class Shows : std::uint8_t {
    kAtOnce,  // under its name from the start, and growing
    kWhole    // when close() puts it in the place of what had its name, in one step; until then it is <name>.new
  };

  // Creates it, and its folders. Throws UserError with the cause.
  OutputFile(std::filesystem::path file, Shows shows);
  ~OutputFile();  // without close(): a kAtOnce file is complete, a kWhole file is discarded
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view text);
  // Gets the file out to where others can read it.
  void flush();
  // Takes back what was written after the first `bytes`.
  void cut(std::uintmax_t bytes);
  std::uintmax_t bytes() const { return written_ + buffer_.size(); }

  // Sentence with file and cause, once when something cannot be written, and once more when the file is given up.
  std::optional<std::string> take_problem();
  // Whether the file was given up: nothing more is written.
  bool ended() const { return ended_; }
  // Flushes. Throws UserError when something is not written by then.
  void check();
  // Throws UserError when something could not be written; then kWhole has left what was there before as it was.
  void close();

 private:
  void fail(int error);
  void write_out();

  const std::filesystem::path file_, opened_;
  const Shows shows_;
  int descriptor_ = -1;
  std::uintmax_t written_ = 0;
  std::string buffer_;
  std::string problem_;  // empty: none
  bool reported_ = false, ended_ = false;
  std::chrono::steady_clock::time_point tried_{};  // last, while there is a problem
};

}  // namespace coslam
