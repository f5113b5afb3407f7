// The files of an EPICS IOC: startup scripts, databases and substitutions, as the ports and records
// that come out of them. Pure.
//
// Bounds: kMaxRecords records; macros are expanded kMaxExpanded bytes long and 10 levels deep.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/format.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxRecords = 100'000;
inline constexpr std::size_t kMaxExpanded = 4096;

using Macros = std::map<std::string, std::string, std::less<>>;

// "$(P)$(R=x)" with the values of the macros; what has none stays as it is.
[[nodiscard]] std::string expand(std::string_view text, const Macros& macros);
// "P=IOC:, R=ai1"
[[nodiscard]] Macros macros_from(std::string_view text);

struct EpicsRecord {
  std::string type, name;
  std::map<std::string, std::string, std::less<>> fields;
  Origin origin;
};

// One call of a startup script.
struct IocCall {
  std::string command;
  std::vector<std::string> arguments;
  Origin origin;
  // Empty behind the last one.
  [[nodiscard]] std::string_view argument(std::size_t index) const {
    return index < arguments.size() ? std::string_view(arguments[index]) : std::string_view();
  }
};

struct EpicsFiles {
  std::vector<IocCall> calls;  // in the order of the scripts, macros expanded
  std::vector<EpicsRecord> records;
  std::vector<Refusal> refusals;   // what could not be loaded
  std::size_t driver_records = 0;  // of the module's own templates, about the driver itself
  bool has_script = false;
};

[[nodiscard]] EpicsFiles load_epics(std::span<const SourceText> sources);

// A startup script: it configures ports of asyn or of Modbus.
[[nodiscard]] bool is_startup_script(std::string_view text);
[[nodiscard]] bool is_database(std::string_view text);
[[nodiscard]] bool is_substitutions(std::string_view text);

// A number of C: decimal, 0x.., or octal behind 0. Nothing for anything else.
[[nodiscard]] std::optional<std::int64_t> c_number(std::string_view text);

}  // namespace fieldcast::importing
