// Checks an uploaded picture: SVG is sanitised, PNG is checked by its chunks. Pure; the bytes are
// untrusted.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace fieldcast::web {

inline constexpr std::size_t kMaxPictureBytes = 256 * 1024;
inline constexpr std::uint32_t kMaxPngSide = 8192;

enum class PictureType : std::uint8_t { kSvg, kPng };

struct Picture {
  PictureType type = PictureType::kSvg;
  std::string content;            // an SVG that the station wrote, or the bytes of the PNG
  double width = 0, height = 0;   // their ratio is that of the picture
  std::set<std::string> removed;  // of an SVG: names that were not copied
};

[[nodiscard]] std::string_view to_text(PictureType type);       // "svg"
[[nodiscard]] std::string_view content_type(PictureType type);  // "image/svg+xml"

// Finds the type by the content. The error is one human-readable line.
[[nodiscard]] tl::expected<Picture, std::string> check_picture(std::string_view bytes);

// Standard base64 (RFC 4648, 4) with padding. Empty if the text is not, or is empty.
[[nodiscard]] std::string from_base64(std::string_view text);
[[nodiscard]] std::string to_base64(std::string_view bytes);

}  // namespace fieldcast::web
