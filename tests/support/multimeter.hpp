// A declared device whose response has two forms and that refuses in two ways.
#pragma once

#include <string_view>

namespace fieldcast::test {

// It sends volts or amperes, as its switch says.
inline constexpr std::string_view kMultimeter = R"(
summary: multimeter
addresses: { from: 1, to: 9 }
areas: [{ name: display, record: true }]
operations:
  - name: read
    read: display
    request: [{ name: ask, constant: "D" }, { is: address }]
    answers:
      - - { name: mode, constant: "V" }
        - { name: volts, is: value, bytes: 2 }
        - { name: battery, is: value }
        - { is: checksum, kind: xor, of: mode..battery }
      - - { name: mode, constant: "A" }
        - { name: battery, is: value }
        - { name: amperes, is: value, bytes: 4 }
        - { is: checksum, kind: xor, of: mode..amperes }
errors:
  frames:
    - [{ name: no, constant: "?" }, { name: code, is: error }]
    - [{ name: busy, constant: "BUSY" }]
  codes: { 7: fuse }
)";

}  // namespace fieldcast::test
