// Commands as people type them, and results as people and scripts read them. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/model/catalogue.hpp"

namespace fieldcast::cli {

// "BUS/DEVICE/CHANNEL=VALUE"; the value is everything after the first '=', and may be empty for a
// string.
struct Assignment {
  ChannelPath path;
  std::string value;
  [[nodiscard]] static tl::expected<Assignment, std::string> parse(std::string_view text);
};

// "BUS/DEVICE" with an empty channel, or "BUS/DEVICE/CHANNEL".
[[nodiscard]] tl::expected<ChannelPath, std::string> parse_device_or_channel(std::string_view text);

// "uint16", "float32", "string(16)".
[[nodiscard]] tl::expected<Encoding, std::string> parse_type(std::string_view text);

// "low", "high", "0" .. "7": which byte of a wider item an 8-bit type means; empty: none.
[[nodiscard]] tl::expected<Encoding, std::string> with_byte(Encoding encoding,
                                                            std::string_view byte);

// The value that `text` spells for a channel of this type. Whether it fits the channel is for the
// bridge to say: an integer channel may be scaled, so a fraction is taken too. The fault is a line
// for people.
[[nodiscard]] tl::expected<Value, std::string> value_from_text(const Encoding& encoding,
                                                               std::string_view text);

// One command and what became of it, or why it was not even sent.
struct Outcome {
  enum class State : unsigned char { kResult, kRefusedHere, kNoResult, kNotSent };
  State state = State::kResult;
  std::string bus, device, target;  // target: the channel or the address
  bool write = false;
  std::vector<Value> wanted;  // of a write
  StationResult result;       // kResult; with kRefusedHere its cause and reason
  std::string type, unit;     // of the channel, where known
};

// A refusal that needs no bridge: an unknown channel, a text that is no value.
[[nodiscard]] Outcome refused_here(const ChannelPath& path, bool write, Cause cause,
                                   std::string reason);

[[nodiscard]] ExitCode exit_code_of(const Outcome& outcome);

// "press-shop/press-1/running = true: verified (read back true) in 12 ms", "...: rejected: ...
// (READ_ONLY)".
[[nodiscard]] std::string outcome_line(const Outcome& outcome);

// {"request_id", "bus", "device", "target", "state", "cause", "reason", "device_code", "values",
// "received_at", "started_at", "completed_at"}; state is a CommandState, or "no-answer" and
// "not-sent" where there is none.
[[nodiscard]] Json outcome_json(const Outcome& outcome);

}  // namespace fieldcast::cli
