// SPDX-License-Identifier: GPL-3.0-or-later
//
// Numbers as people read them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ptin::tools {

/// 1234567 -> "1,234,567".
[[nodiscard]] std::string grouped(std::uint64_t n);
/// "1 page", "1,234 pages". `plural` is needed where it is not `one` with an s.
[[nodiscard]] std::string counted(std::uint64_t n, const std::string& one,
                                  const std::string& plural = {});
/// Ten significant digits, in groups of three before the point: "83,780,376.2".
[[nodiscard]] std::string grouped_number(double value);
/// A number with the digits behind the point that are certain, and no more than seven digits where some
/// are: "83,780,376", "1,234.5".
/// @param uncertain  How far the value may be off, at most.
[[nodiscard]] std::string grouped_number(double value, double uncertain);
/// Several of a unit: "metres", "US survey feet".
[[nodiscard]] std::string plural_of(const std::string& unit);
/// Bytes as "3.2 MiB"; below 1024 "512 bytes".
[[nodiscard]] std::string human_bytes(std::uint64_t bytes);
/// Seconds as "12 s", "3 min", "1.5 h".
[[nodiscard]] std::string human_duration(double seconds);
/// Six significant digits without trailing zeros; "inf" when infinite.
[[nodiscard]] std::string short_number(double value);
/// The text with question marks in the place of control characters: what a file says must not steer
/// the terminal.
[[nodiscard]] std::string printable(std::string text);
/// A text that somebody gave as a sentence quotes it: cut behind 64 bytes, at the end of a character.
[[nodiscard]] std::string shown(std::string_view text);
/// The words of each line of a text in lines of at most `width` bytes; a longer word has one of its own.
[[nodiscard]] std::vector<std::string> wrapped(const std::string& text, std::size_t width);
/// A file's name as a word of a shell's command: in quotes where it holds anything but letters,
/// digits and the signs that no shell minds.
[[nodiscard]] std::string shell_word(const std::string& name);
/// The fewest digits that read back as the same number.
[[nodiscard]] std::string exact_number(double value);
/// A size in bytes from "512M", "2G", "4096": suffixes K, M, G, T are powers of 1024.
/// @param option  Gave the text; named in errors.
/// @throws Error invalid_argument
[[nodiscard]] std::uint64_t parse_bytes(const std::string& text, const std::string& option);
/// A size of memory, as parse_bytes. A number below 65 536 without a suffix is refused: nobody means
/// 128 bytes by 128.
[[nodiscard]] std::uint64_t parse_memory(const std::string& text, const std::string& option);

}  // namespace ptin::tools
