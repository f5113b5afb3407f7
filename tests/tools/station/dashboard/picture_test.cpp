#include "tools/station/dashboard/picture.hpp"

#include <gtest/gtest.h>

namespace fieldcast::web {
namespace {

std::string big_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xff);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + "crc.";
}

const std::string kSignature = "\x89PNG\r\n\x1a\n";

// Signature, IHDR, IDAT, IEND.
std::string png(std::uint32_t width, std::uint32_t height, const std::string& data = "data") {
  return kSignature +
         chunk("IHDR", big_endian(width) + big_endian(height) + std::string("\x08\x02\0\0\0", 5)) +
         chunk("IDAT", data) + chunk("IEND", "");
}

std::string fault_of(const std::string& bytes) {
  const auto checked = check_picture(bytes);
  return checked ? "accepted" : checked.error();
}

TEST(Picture, PngHasTheSizeOfItsHeader) {
  const auto picture = check_picture(png(640, 480));
  ASSERT_TRUE(picture) << picture.error();
  EXPECT_EQ(picture->type, PictureType::kPng);
  EXPECT_EQ(picture->width, 640);
  EXPECT_EQ(picture->height, 480);
  EXPECT_EQ(picture->content, png(640, 480));
}

TEST(Picture, DamagedPngIsRefused) {
  EXPECT_EQ(fault_of(kSignature), "the PNG is damaged: it does not begin with IHDR; save it again");
  EXPECT_EQ(fault_of(kSignature + chunk("IDAT", "1234567890123")),
            "the PNG is damaged: it does not begin with IHDR; save it again");
  const std::string good = png(2, 2);
  for (std::size_t size = kSignature.size(); size < good.size(); ++size)
    EXPECT_NE(fault_of(good.substr(0, size)), "accepted") << size;
  EXPECT_EQ(fault_of(good + "<script>"), "the PNG is damaged: bytes follow IEND; save it again");
  EXPECT_EQ(fault_of(kSignature + chunk("IHDR", std::string("\0\0\0\1\0\0\0\1\x08\x02\0\0\0", 13)) +
                     big_endian(0xffffffff) + "IDAT...."),
            "the PNG is damaged: a chunk is longer than the file; save it again");
  EXPECT_EQ(fault_of(kSignature + chunk("IHDR", std::string("\0\0\0\1\0\0\0\1\x08\x02\0\0\0", 13)) +
                     chunk("IEND", "")),
            "the PNG is damaged: it has no IDAT; save it again");
}

TEST(Picture, PngThatWouldFillTheMemoryOfABrowserIsRefused) {
  EXPECT_NE(fault_of(png(0, 1)), "accepted");
  EXPECT_NE(fault_of(png(8193, 1)), "accepted");
  EXPECT_NE(fault_of(png(8192, 8192)), "accepted");
  EXPECT_EQ(fault_of(png(4000, 4000)), "accepted");
}

TEST(Picture, OversizedPictureIsRefused) {
  EXPECT_EQ(fault_of(png(2, 2, std::string(kMaxPictureBytes, 'x'))).substr(0, 23),
            "the picture has 262201 ");
  std::string grows = "<svg viewBox='0 0 1 1'>";
  for (int i = 0; i < 15'000; ++i) grows += "<title>'</title>";
  EXPECT_TRUE(fault_of(grows + "</svg>").starts_with("the sanitised SVG has"));
}

TEST(Picture, SvgIsSanitised) {
  const auto picture =
      check_picture("<svg viewBox='0 0 3 4' onload='alert(1)'><script>alert(1)</script></svg>");
  ASSERT_TRUE(picture) << picture.error();
  EXPECT_EQ(picture->type, PictureType::kSvg);
  EXPECT_EQ(picture->content,
            R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 3 4"></svg>)");
  EXPECT_EQ(picture->removed, (std::set<std::string>{"onload", "script"}));
}

TEST(Picture, OtherFilesAreRefused) {
  for (const char* bytes : {"GIF89a", "\xff\xd8\xff\xe0", "<html></html>", "", "%PDF-1.7"})
    EXPECT_TRUE(fault_of(bytes).starts_with("neither PNG nor SVG")) << bytes;
}

TEST(Picture, Base64IsReadAndWritten) {
  for (const std::string& bytes :
       {std::string("a"), std::string("ab"), std::string("abc"), std::string("\0\xff\x80 x", 5)})
    EXPECT_EQ(from_base64(to_base64(bytes)), bytes);
  EXPECT_EQ(to_base64("ab"), "YWI=");
  for (const char* wrong : {"", "YWI", "YWI=x", "YW I=", "Y-I=", "=", "data:image/png;base64,YWI="})
    EXPECT_EQ(from_base64(wrong), "") << wrong;
}

}  // namespace
}  // namespace fieldcast::web
