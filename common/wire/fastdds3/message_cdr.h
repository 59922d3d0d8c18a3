// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/CdrSizeCalculator.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Messages of the IDL as plain CDR, little endian, without an encapsulation header. Message: of idl/coslam.h.
namespace coslam {

template <class Message>
std::size_t cdr_bytes(const Message& message) {
  eprosima::fastcdr::CdrSizeCalculator calculator(eprosima::fastcdr::CdrVersion::XCDRv1);
  std::size_t from = 0;
  return calculator.calculate_serialized_size(message, from);
}

// Writes it to the front of `octets`, which has room; returns how many octets it has.
template <class Message>
std::size_t write_cdr(const Message& message, std::span<std::uint8_t> octets) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(octets.data()), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  cdr << message;
  return cdr.get_serialized_data_length();
}

// Reads a message; false: the octets are not one as a whole. Throws exceptions of several kinds.
template <class Message>
bool read_cdr(std::span<std::uint8_t> octets, Message& message) {
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(octets.data()), octets.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  cdr >> message;
  // A message that was cut off is read as one whose last members are empty.
  std::vector<std::uint8_t> again(cdr_bytes(message));
  return cdr.get_serialized_data_length() == octets.size() && write_cdr(message, again) == octets.size();
}

}  // namespace coslam
