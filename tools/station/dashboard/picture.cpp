#include "tools/station/dashboard/picture.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>

#include "tools/station/dashboard/svg_sanitizer.hpp"

namespace fieldcast::web {

namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kChunkFrame = 12;  // length(4) type(4) .. crc(4)
constexpr std::uint64_t kMaxPixels = 16'000'000;

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char c : bytes.substr(0, 4)) number = number << 8 | static_cast<unsigned char>(c);
  return number;
}

// PNG 1.2, 3.2: IHDR first, IEND last, every length within the file, and no bytes behind IEND.
tl::expected<Picture, std::string> checked_png(std::string_view bytes) {
  const auto damaged = [](std::string_view why) {
    return tl::make_unexpected(fmt::format("the PNG is damaged: {}; save it again", why));
  };
  std::string_view left = bytes.substr(kPngSignature.size());
  if (left.size() < kChunkFrame + 13 || big_endian(left) != 13 || left.substr(4, 4) != "IHDR")
    return damaged("it does not begin with IHDR");
  const std::uint32_t width = big_endian(left.substr(8)), height = big_endian(left.substr(12));
  if (width == 0 || height == 0 || width > kMaxPngSide || height > kMaxPngSide ||
      std::uint64_t{width} * height > kMaxPixels)
    return tl::make_unexpected(
        fmt::format("the PNG has {} x {} pixels; at most {} on each side and {} in all are allowed",
                    width, height, kMaxPngSide, kMaxPixels));
  bool data = false;
  for (;;) {
    if (left.size() < kChunkFrame) return damaged("it ends before IEND");
    const std::uint32_t length = big_endian(left);
    const std::string_view type = left.substr(4, 4);
    if (length > left.size() - kChunkFrame) return damaged("a chunk is longer than the file");
    left.remove_prefix(kChunkFrame + length);
    data = data || type == "IDAT";
    if (type == "IEND") break;
  }
  if (!data) return damaged("it has no IDAT");
  if (!left.empty()) return damaged("bytes follow IEND");
  return Picture{PictureType::kPng,
                 std::string(bytes),
                 static_cast<double>(width),
                 static_cast<double>(height),
                 {}};
}

}  // namespace

std::string_view to_text(PictureType type) { return type == PictureType::kSvg ? "svg" : "png"; }
std::string_view content_type(PictureType type) {
  return type == PictureType::kSvg ? "image/svg+xml" : "image/png";
}

tl::expected<Picture, std::string> check_picture(std::string_view bytes) {
  if (bytes.size() > kMaxPictureBytes)
    return tl::make_unexpected(fmt::format("the picture has {} bytes; at most {} are allowed",
                                           bytes.size(), kMaxPictureBytes));
  if (bytes.starts_with(kPngSignature)) return checked_png(bytes);
  auto svg = sanitized_svg(bytes);
  if (!svg) return tl::make_unexpected("neither PNG nor SVG: " + svg.error());
  if (svg->text.size() > kMaxPictureBytes)
    return tl::make_unexpected(fmt::format("the sanitised SVG has {} bytes; at most {} are allowed",
                                           svg->text.size(), kMaxPictureBytes));
  return Picture{PictureType::kSvg, std::move(svg->text), svg->width, svg->height,
                 std::move(svg->removed)};
}

std::string from_base64(std::string_view text) {
  std::string bytes(text.size() / 4 * 3 + 3, '\0');
  std::size_t size = 0;
  const char* end = nullptr;
  const int fault =
      sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), text.data(),
                        text.size(), nullptr, &size, &end, sodium_base64_VARIANT_ORIGINAL);
  if (fault != 0 || end != text.data() + text.size()) return {};
  bytes.resize(size);
  return bytes;
}

std::string to_base64(std::string_view bytes) {
  std::string text(sodium_base64_encoded_len(bytes.size(), sodium_base64_VARIANT_ORIGINAL), '\0');
  sodium_bin2base64(text.data(), text.size(), reinterpret_cast<const unsigned char*>(bytes.data()),
                    bytes.size(), sodium_base64_VARIANT_ORIGINAL);
  text.pop_back();  // the zero of the C string
  return text;
}

}  // namespace fieldcast::web
