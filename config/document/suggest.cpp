#include "config/document/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/message_text.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

namespace {

// Keys of other programs. `text`: the entry to write if the value differs too.
struct KeyHabit {
  std::string_view habit, ours;
  std::string_view text = {};
};
constexpr KeyHabit kKeyHabits[] = {{"address", "at"},
                                   {"adress", "at"},
                                   {"addr", "at"},
                                   {"register", "at"},
                                   {"slave", "address"},
                                   {"slave-id", "address"},
                                   {"slaveid", "address"},
                                   {"unit-id", "address"},
                                   {"node", "address"},
                                   {"station", "address"},
                                   {"id", "address"},
                                   {"period", "refresh"},
                                   {"poll", "refresh"},
                                   {"poll-rate", "refresh"},
                                   {"scan-rate", "refresh"},
                                   {"rate", "refresh"},
                                   {"cycle", "refresh"},
                                   {"interval", "refresh"},
                                   {"baudrate", "baud"},
                                   {"baud-rate", "baud"},
                                   {"speed", "baud"},
                                   {"parity", "format", "format: 8E1"},
                                   {"stop-bits", "format", "format: 8N1"},
                                   {"stopbits", "format", "format: 8N1"},
                                   {"stop_bits", "format", "format: 8N1"},
                                   {"data-bits", "format", "format: 8N1"},
                                   {"databits", "format", "format: 8N1"},
                                   {"data_bits", "format", "format: 8N1"},
                                   {"bytesize", "format", "format: 8N1"},
                                   {"host", "tcp", "tcp: HOST:PORT"},
                                   {"ip", "tcp", "tcp: HOST:PORT"},
                                   {"path", "serial"},
                                   {"tty", "serial"},
                                   {"device", "serial"},
                                   {"units", "unit"},
                                   {"comment", "description"},
                                   {"factor", "scale"},
                                   {"gain", "scale"},
                                   {"multiplier", "scale"},
                                   {"datatype", "type"},
                                   {"data-type", "type"},
                                   {"length", "type", "type: string(N)"},
                                   {"endian", "word-order"},
                                   {"endianness", "word-order"},
                                   {"swap", "word-order", "word-order: little-endian"},
                                   {"swap-words", "word-order", "word-order: little-endian"},
                                   {"swap-bytes", "byte-order", "byte-order: little-endian"},
                                   {"writable", "access", "access: read-write"},
                                   {"writeable", "access", "access: read-write"},
                                   {"readonly", "access", "access: read-only"},
                                   {"read-only", "access", "access: read-only"},
                                   {"raw-write", "allow", "allow: [raw-write]"},
                                   {"raw-read", "allow", "allow: [raw-read]"},
                                   {"tags", "channels"},
                                   {"points", "channels"},
                                   {"slaves", "devices"}};

// Values of other programs, and of older versions, in lower case. ABCD and similar: byte order.
struct ValueHabit {
  std::string_view key, habit, ours;
};
constexpr ValueHabit kValueHabits[] = {
    {"access", "rw", "read-write"},
    {"access", "r/w", "read-write"},
    {"access", "wr", "read-write"},
    {"access", "read/write", "read-write"},
    {"access", "write", "write-only"},
    {"access", "w", "write-only"},
    {"access", "wo", "write-only"},
    {"access", "read", "read-only"},
    {"access", "r", "read-only"},
    {"access", "ro", "read-only"},
    {"mode", "poll", "scheduled"},
    {"mode", "polling", "scheduled"},
    {"mode", "cyclic", "scheduled"},
    {"mode", "periodic", "scheduled"},
    {"mode", "continuous", "intensive"},
    {"mode", "fast", "intensive"},
    {"mode", "manual", "on-demand"},
    {"mode", "command", "on-demand"},
    {"planner", "riding", "cyclic"},
    {"level", "warn", "warning"},
    {"level", "trace", "debug"},
    {"level", "verbose", "debug"},
    {"word-order", "abcd", "big-endian"},
    {"word-order", "cdab", "little-endian"},
    {"word-order", "badc", "byte-order: little-endian"},
    {"word-order", "dcba", "little-endian, with byte-order: little-endian"},
    {"word-order", "swapped", "little-endian"},
    {"word-order", "swap", "little-endian"},
    {"word-order", "le", "little-endian"},
    {"word-order", "lsw", "little-endian"},
    {"word-order", "be", "big-endian"},
    {"word-order", "msw", "big-endian"},
    {"byte-order", "abcd", "big-endian"},
    {"byte-order", "cdab", "word-order: little-endian"},
    {"byte-order", "badc", "little-endian"},
    {"byte-order", "dcba", "little-endian, with word-order: little-endian"},
    {"byte-order", "swapped", "little-endian"},
    {"byte-order", "le", "little-endian"},
    {"byte-order", "be", "big-endian"}};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

const KeyHabit* habit_of(std::string_view word, std::span<const std::string_view> candidates) {
  const auto row = std::ranges::find_if(kKeyHabits, [&](const KeyHabit& each) {
    return each.habit == word && std::ranges::find(candidates, each.ours) != candidates.end();
  });
  return row == std::end(kKeyHabits) ? nullptr : row;
}

}  // namespace

std::string closest(std::string_view word, std::span<const std::string_view> candidates) {
  if (const auto* habit = habit_of(word, candidates)) return std::string(habit->ours);
  const auto near = near_miss(word, candidates);
  if (!near.empty() || word.size() < 3) return std::string(near);
  for (const auto candidate : candidates) {
    if (candidate.starts_with(word)) return std::string(candidate);
  }
  return {};
}

MeantKey meant_key(std::string_view word, std::span<const std::string_view> keys) {
  // "name:a" in { name:a }: without the space, all of it is a key.
  if (const auto colon = word.find(':'); colon != std::string_view::npos) {
    const auto key = word.substr(0, colon);
    if (std::ranges::find(keys, key) != keys.end())
      return {std::string(key), fmt::format("{}: {}", key, word.substr(colon + 1))};
  }
  if (const auto* habit = habit_of(lower(word), keys); habit != nullptr && !habit->text.empty())
    return {std::string(habit->ours), std::string(habit->text)};
  const auto key = closest(word, keys);
  return {key, key};
}

std::string meant_value(std::string_view key, std::string_view written) {
  const auto word = lower(written);
  for (const auto& row : kValueHabits) {
    if (row.key == key && row.habit == word) return std::string(row.ours);
  }
  if (key != "protocol") return {};
  for (const ProtocolEntry& entry : protocols()) {
    const auto alias = std::ranges::find(entry.aliases, word, &ProtocolAlias::alias);
    if (alias != entry.aliases.end())
      return std::string(alias->hint.empty() ? entry.name : alias->hint);
  }
  return {};
}

std::string joined(std::span<const std::string_view> words) {
  std::string result;
  for (const auto word : words) {
    if (!result.empty()) result += ", ";
    result += word;
  }
  return result;
}

}  // namespace fieldcast::config
