// Texts about protocols for several tables, from the rows of core/protocol/families/registry.hpp.
#pragma once

#include <string>

#include "config/document/document.hpp"
#include "core/codec/text_codec.hpp"

namespace fieldcast::config {

// "`modbus-rtu`: `mask-write: true` ..; `dtc`: ..": the options of every protocol.
[[nodiscard]] std::string options_text();

// "19200; `s7-ppi` 9600": the factory baud rates.
[[nodiscard]] std::string factory_bauds();
// "8E1; `modbus-ascii` 7E1": the factory data bits, parity and stop bits.
[[nodiscard]] std::string factory_formats();

// "`dtc`, `modbus-rtu`, ..".
[[nodiscard]] std::string protocol_names();
// "modbus-tcp, ..": protocols that can have several requests in flight.
[[nodiscard]] std::string pipelined_protocol_names();

// "decimal(7)", "decimal-comma(7)", "hex(4)", or a picture such as "+000.00".
inline constexpr std::int64_t kMaxTextCharacters = 250;

inline constexpr std::string_view kTextNumberForms =
    "decimal(n), decimal-comma(n) or hex(n) of n characters, or a picture such as \"+000.00\"";

struct TextForm {
  TextNumber number;             // none: the characters are a text
  std::uint16_t characters = 0;  // 0 if not given
};

// Also accepts "decimal" and similar without a size, if the address determines it.
struct TextFormRule {
  std::optional<TextForm> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
