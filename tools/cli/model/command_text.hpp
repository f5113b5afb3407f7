// Parses typed commands and formats results as text and JSON. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// "BUS/DEVICE/CHANNEL=VALUE"; the value is everything after the first '='.
struct Assignment {
  ChannelPath path;
  std::string value;
  [[nodiscard]] static tl::expected<Assignment, std::string> parse(std::string_view text);
};

// "BUS/DEVICE" with an empty channel, or "BUS/DEVICE/CHANNEL".
[[nodiscard]] tl::expected<ChannelPath, std::string> parse_device_or_channel(std::string_view text);

[[nodiscard]] tl::expected<Encoding, std::string> parse_type(std::string_view text);

// "low", "high", "0" .. "7": byte of a wider item for an 8-bit type; empty: none.
[[nodiscard]] tl::expected<Encoding, std::string> with_byte(Encoding encoding,
                                                            std::string_view byte);

struct ValueFault {
  Cause cause = Cause::kWrongType;  // or kRange
  std::string text;
};
// The bridge checks the channel's limits and scale, so fractions are accepted.
[[nodiscard]] tl::expected<Value, ValueFault> value_from_text(const Encoding& encoding,
                                                              std::string_view text);

struct Outcome {
  enum class State : unsigned char { kResult, kRefusedHere, kNoResult, kNotSent };
  State state = State::kResult;
  std::string bus, device, target;  // target: the channel or the address
  bool write = false;
  std::vector<Value> wanted;  // values of a write
  StationResult result;       // kResult; with kRefusedHere only cause and reason
  std::string type, unit;     // of the channel, if known
};

[[nodiscard]] Outcome refused_here(const ChannelPath& path, bool write, Cause cause,
                                   std::string reason);

[[nodiscard]] ExitCode exit_code_of(CommandState state);
[[nodiscard]] ExitCode exit_code_of(const Outcome& outcome);

// "press-shop/press-1/running = true: verified (read back true) in 12 ms".
[[nodiscard]] std::string outcome_line(const Outcome& outcome);

// {"request_id", "bus", "device", "target", "state", "cause", "reason", "device_code", "values",
// "received_at", "started_at", "completed_at"}; `state` is a CommandState, or "no-answer" or
// "not-sent".
[[nodiscard]] Json outcome_json(const Outcome& outcome);

}  // namespace fieldcast::cli
