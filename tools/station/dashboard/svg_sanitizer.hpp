// Copies the harmless part of an SVG picture. Pure; the text is untrusted.
//
// The result is a new document of the allowed elements and attributes only: no script, no event, no
// style sheet, no reference to a file or an address, no element that repeats another.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::web {

inline constexpr std::size_t kMaxSvgElements = 20'000;
inline constexpr int kMaxSvgDepth = 64;
// A gradient may refer to a gradient; so a chain of them has an end.
inline constexpr std::size_t kMaxSvgReferences = 500;

struct SanitizedSvg {
  std::string text;
  double width = 0, height = 0;   // of its view box
  std::set<std::string> removed;  // "script", "onload", "href of a"; at most kMaxRemoved
};
inline constexpr std::size_t kMaxRemoved = 20;

// The error is one human-readable line.
[[nodiscard]] tl::expected<SanitizedSvg, std::string> sanitized_svg(std::string_view text);

}  // namespace fieldcast::web
