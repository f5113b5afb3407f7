#include "core/protocol/mitsubishi_mc/frame.hpp"

#include <algorithm>

#include "core/codec/digits.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

// The subheader of a 4E frame, or its beginning, has zeros after the serial number.
bool begins_like_response(ByteView all, const Format& format) {
  Bytes first;
  append_number(first, format, (format.numbered ? kRequest4e : kRequest3e) | kResponse, 1);
  append_number(first, format, 0, 1);
  const auto agrees = [&](std::size_t at, ByteView part) {
    const std::size_t present = all.size() > at ? std::min(all.size() - at, part.size()) : 0;
    return std::ranges::equal(part.first(present),
                              all.subspan(std::min(at, all.size())).first(present));
  };
  if (!agrees(0, first)) return false;
  if (!format.numbered) return true;
  const Bytes zeros(2 * format.width(), format.ascii ? '0' : 0);
  return agrees((kSubheader + 2) * format.width(), zeros);
}

std::optional<Route> read_route(ByteView text, const Format& format) {
  const std::size_t width = format.width();
  const auto network = read_number(text, format, 1),
             station = read_number(text.subspan(width), format, 1),
             module = read_number(text.subspan(2 * width), format, 2),
             unit = read_number(text.subspan(4 * width), format, 1);
  if (!network || !station || !module || !unit) return std::nullopt;
  return Route{static_cast<std::uint8_t>(*network), static_cast<std::uint8_t>(*station),
               static_cast<std::uint16_t>(*module), static_cast<std::uint8_t>(*unit)};
}

}  // namespace

void append_number(Bytes& out, const Format& format, std::uint32_t value, std::size_t bytes) {
  if (format.ascii) return append_digits(out, value, static_cast<unsigned>(2 * bytes));
  for (; bytes > 0; --bytes, value >>= 8) out.push_back(static_cast<std::uint8_t>(value));
}

std::optional<std::uint32_t> read_number(ByteView text, const Format& format, std::size_t bytes) {
  if (format.ascii) return read_digits(text.first(2 * bytes));
  std::uint32_t value = 0;
  while (bytes > 0) value = value << 8 | text[--bytes];
  return value;
}

void append_request(Bytes& out, const Format& format, std::uint16_t serial, const Route& route,
                    std::uint16_t timer, ByteView content) {
  append_number(out, format, format.numbered ? kRequest4e : kRequest3e, 1);
  append_number(out, format, 0, 1);
  if (format.numbered) {
    append_number(out, format, serial, 2);
    append_number(out, format, 0, 2);
  }
  append_number(out, format, route.network, 1);
  append_number(out, format, route.station, 1);
  append_number(out, format, route.module, 2);
  append_number(out, format, route.unit, 1);
  append_number(out, format, static_cast<std::uint32_t>(kTimer * format.width() + content.size()),
                kLength);
  append_number(out, format, timer, kTimer);
  append(out, content);
}

Response first_response(ByteView all, const Format& format) {
  const std::size_t width = format.width(), header = header_size(format);
  const Response hopeless{.kind = Response::Kind::kHopeless};
  if (!begins_like_response(all, format)) return hopeless;
  if (all.size() < header) return {};
  const auto length = read_number(all.subspan(header - kLength * width), format, kLength);
  const auto route = read_route(all.subspan(header - (kRoute + kLength) * width), format);
  const auto serial = format.numbered ? read_number(all.subspan(kSubheader * width), format, 2) : 0;
  const std::size_t least = kEndCode * width,
                    most = least + (format.ascii ? kMaxDataAscii : kMaxDataBinary);
  if (!length || !route || !serial || *length < least || *length > most) return hopeless;
  if (all.size() < header + *length) return {};
  const ByteView content = all.subspan(header, *length);
  const auto end_code = read_number(content, format, kEndCode);
  if (!end_code) return hopeless;
  return {.kind = Response::Kind::kWhole,
          .size = header + *length,
          .serial = static_cast<std::uint16_t>(*serial),
          .route = *route,
          .end_code = static_cast<std::uint16_t>(*end_code),
          .data = content.subspan(least)};
}

}  // namespace fieldcast::mitsubishi_mc
