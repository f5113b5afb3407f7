// Encodes channel values as frames of /live. Pure functions.
//
//     binary, little-endian    u8 1 | u8 0 | u16 0 | u32 n | f64 base_ms | f64 value[n] | u32 id[n]
//                              | u32 age_ms[n] | u8 quality[n]
//     text                     {"kind":"values", "id":[], "value":[texts], "acquired_ms":[],
//                              "quality":[]}
//
// A value was acquired at base_ms - age_ms (Unix milliseconds). Its quality is the number of the
// topic's enumerator. A bool is 0 or 1. NaN means never acquired, or a value in the text message: a
// string, or an integer beyond 2^53.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kNoAge = 0xFFFFFFFF;  // never acquired, or more than 49 days ago
inline constexpr std::size_t kFrameHeader = 16;      // bytes
inline constexpr std::size_t kFrameRow = 17;         // bytes of one channel

using Channels = std::vector<const LiveChannel*>;

[[nodiscard]] bool needs_text(const Value& value);

// `channels` may be empty; the frame then reports no change.
[[nodiscard]] std::string binary_frame(const Channels& channels);
// Returns an empty text if no channel needs it.
[[nodiscard]] std::string values_message(const Channels& channels);

}  // namespace fieldcast::web
