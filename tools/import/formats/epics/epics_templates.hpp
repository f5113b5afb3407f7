// Record templates of the EPICS modbus module, which users need not pass. Pure.
// Source: epics-modules/modbus modbusApp/Db.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/import/formats/epics/epics_files.hpp"

namespace fieldcast::importing {

// Its macros are unexpanded; empty for other files.
[[nodiscard]] std::optional<EpicsRecord> module_template(std::string_view file);

// Records about the driver itself: statistics, delays, the asyn record.
[[nodiscard]] bool is_driver_template(std::string_view file);

// Tokens of EPICS databases and substitutions: names, quoted texts, brackets, commas. Pure.

struct EpicsToken {
  std::string text;
  unsigned line = 0;    // from 1
  bool quoted = false;  // never a bracket
  [[nodiscard]] bool is(std::string_view mark) const { return !quoted && text == mark; }
};

class EpicsTokens {
 public:
  explicit EpicsTokens(std::string_view text) : text_(text) {}
  // Empty at the end.
  [[nodiscard]] std::optional<EpicsToken> next();

 private:
  void skip_blanks();
  std::string_view text_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
};

}  // namespace fieldcast::importing
