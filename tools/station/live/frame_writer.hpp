// Values of channels as the frames of /live. Pure functions.
//
//     binary, little-endian    u8 1 | u8 0 | u16 0 | u32 n | f64 base_ms | f64 value[n] | u32 id[n]
//                              | u32 age_ms[n] | u8 quality[n]
//     text                     {"kind":"values", "id":[], "value":[texts], "acquired_ms":[],
//                              "quality":[]}
//
// A value was acquired at base_ms - age_ms (Unix milliseconds). Its quality is the number of the
// topic's enumerator. A bool is 0 or 1. NaN stands for a value that was never acquired, and for
// one that the text tells: a string, or an integer beyond 2^53.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/station/live/live_model.hpp"

namespace fieldcast::web {

inline constexpr std::uint32_t kNoAge = 0xFFFFFFFF;  // never acquired, or longer ago than 49 days
inline constexpr std::size_t kFrameHeader = 16;      // bytes
inline constexpr std::size_t kFrameRow = 17;         // bytes of one channel

using Channels = std::vector<const LiveChannel*>;

// Whether the value goes by the text, too.
[[nodiscard]] bool needs_text(const Value& value);

// Also of no channel: then it says that nothing changed.
[[nodiscard]] std::string binary_frame(const Channels& channels);
// Empty: none of them needs it.
[[nodiscard]] std::string values_message(const Channels& channels);

}  // namespace fieldcast::web
