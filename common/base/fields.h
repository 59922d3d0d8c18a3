// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <tuple>
#include <type_traits>

// The list of a struct's members, written once, beside the struct:
//
//   struct Example {
//     SetId set;
//     TimeNs taken_ns = 0;
//     int tries = 0;
//   };
//   auto fields(Like<Example> auto& e) {
//     return std::tuple(kept("set", e.set), instant("taken_ns", e.taken_ns), not_kept("tries", e.tries));
//   }
//
// Files, fingerprints, equality, sizes, renumbering and checks go through this list (each_field). A member that is not
// in it does not compile. A struct with base classes names them, as `using Parts = std::tuple<Base, OtherBase>`, and
// lists their members with its own.
namespace coslam {

template <class T, class Struct>
concept Like = std::same_as<std::remove_const_t<T>, Struct>;

enum class FieldKind { kKept, kInstant, kNotKept };

template <class T, FieldKind kKind>
struct Field {
  static constexpr bool kIsKept = kKind != FieldKind::kNotKept;
  static constexpr bool kIsInstant = kKind == FieldKind::kInstant;
  const char* name = nullptr;
  T& value;
  int since = 0;  // version of the file that has it first
};

// Outlives its server, in the map file.
template <class T>
Field<T, FieldKind::kKept> kept(const char* name, T& value, int since = 0) {
  return {name, value, since};
}
// A kept field that holds one or several instants: they move when all times are shifted.
template <class T>
Field<T, FieldKind::kInstant> instant(const char* name, T& value) {
  return {name, value};
}
// A field that means nothing to another server, or lies elsewhere in the file.
template <class T>
Field<T, FieldKind::kNotKept> not_kept(const char* name, T& value) {
  return {name, value};
}

template <class T>
concept HasFields = requires(T& value) {
  fields(value);
};

namespace detail {

// Stands for a member of any type, where it is only asked what compiles.
struct AnyMember {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): converts by intent
};

template <class Struct, class... Members>
consteval std::size_t member_count() {
  if constexpr (requires { Struct{Members{}..., AnyMember{}}; }) {
    return member_count<Struct, Members..., AnyMember>();
  } else {
    return sizeof...(Members);
  }
}

template <class Struct>
concept HasParts = requires {
  typename Struct::Parts;
};

template <class Struct, class... Parts>
consteval std::size_t member_count_with(std::type_identity<std::tuple<Parts...>> /*parts*/) {
  return member_count<Struct>() - sizeof...(Parts) + (member_count<Parts>() + ...);
}

// Number of members, also of those in base classes, which Struct::Parts names.
template <class Struct>
consteval std::size_t all_member_count() {
  if constexpr (HasParts<Struct>) {
    return member_count_with<Struct>(std::type_identity<typename Struct::Parts>());
  } else {
    return member_count<Struct>();
  }
}

}  // namespace detail

// Calls visit(field) with each field of the struct, in the order of its list.
template <HasFields T, class Visit>
void each_field(T& value, Visit visit) {
  using Struct = std::remove_const_t<T>;
  static_assert(std::tuple_size_v<decltype(fields(value))> == detail::all_member_count<Struct>(),
                "fields() lacks a member of this struct, or has one twice");
  std::apply([&](const auto&... field) { (visit(field), ...); }, fields(value));
}

// Calls visit(field) with each field that is kept in the map file.
template <HasFields T, class Visit>
void each_kept_field(T& value, Visit visit) {
  each_field(value, [&](const auto& field) {
    if constexpr (std::remove_cvref_t<decltype(field)>::kIsKept) visit(field);
  });
}

}  // namespace coslam
