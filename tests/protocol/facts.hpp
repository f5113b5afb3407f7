// Texts of what a protocol offers: areas, addresses, and the requests for them.
#pragma once

#include <algorithm>
#include <string>

#include "core/protocol/protocol.hpp"

namespace fieldcast::test {

inline std::string area_text(const Area& area) {
  std::string text = "  " + std::string(area.name) + ": " + std::to_string(area.items) + " of " +
                     std::to_string(area.item_bits) + " bits, read " +
                     std::to_string(area.max_read) + ", write " +
                     (area.writable ? std::to_string(area.max_write) : "-");
  if (area.type) text += ", " + std::string(to_text(*area.type));
  if (area.alignment != 1) text += ", aligned to " + std::to_string(area.alignment);
  if (area.bank != 0) text += ", banks of " + std::to_string(area.bank);
  for (const auto& [is, name] :
       {std::pair{area.bit_write, "bits"},
        {area.byte_write, "bytes"},
        {area.mask_write, "masks"},
        {area.window, "window"},
        {area.counted, "counted"},
        {area.word_order == WordOrder::kLittleEndian, "low word first"},
        {area.text_order == ByteOrder::kLittleEndian, "low character first"}})
    text += is ? std::string(", ") + name : "";
  return text + '\n';
}

inline std::string request_text(const Protocol& protocol, const Request& request) {
  const auto size = protocol.size(request);
  if (!size) return "not possible\n";
  Bytes out;
  (void)protocol.begin(request, {1})->start(out);
  return std::to_string(size->request_characters) + " + " +
         std::to_string(size->response_characters) + " in " + std::to_string(size->rounds) + ": " +
         to_hex(out) + '\n';
}

inline std::string address_text(const Protocol& protocol, std::string_view at) {
  const auto parsed = protocol.parse_address(at);
  if (!parsed)
    return "  '" + std::string(at) + "': " + parsed.error().what + "; " +
           parsed.error().suggestion + '\n';
  std::string text = "  " + std::string(at) + ": " +
                     std::string(protocol.areas()[parsed->area].name) + ' ' +
                     std::to_string(parsed->first);
  if (parsed->bit) text += '.' + std::to_string(*parsed->bit);
  if (parsed->width_bits) text += ", " + std::to_string(*parsed->width_bits) + " bits";
  if (parsed->text_characters != 0)
    text += ", " + std::to_string(parsed->text_characters) + " characters";
  return text + '\n';
}

// Characters of request and response, rounds, and the first frame: "8 + 11 in 1: 01 03 ...".
inline std::string requests_text(const Protocol& protocol, const ParsedAddress& at) {
  const Area& area = protocol.areas()[at.area];
  const std::uint32_t count =
      std::max<std::uint32_t>(area.alignment, 3 / area.alignment * area.alignment);
  const Range range{at.area, at.first - at.first % area.alignment, count};
  const auto write = [&](std::uint32_t items, std::optional<std::uint8_t> bit) {
    WriteRequest request{{at.area, range.first, items},
                         Bytes(image_bytes(area.item_bits, items), 1)};
    request.bit = bit;
    return request_text(protocol, request);
  };
  return "    read " + request_text(protocol, ReadRequest{{range}}) + "    write two " +
         write(2, {}) + "    write one " + write(1, {}) + "    write a bit " + write(1, 0);
}

}  // namespace fieldcast::test
