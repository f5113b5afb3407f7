#include "core/base/csv_field.hpp"

#include <string_view>

#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

// Spreadsheets evaluate a cell that starts with one of these as a formula.
constexpr std::string_view kFormulaStarts = "=+-@\t\r";

}  // namespace

std::string csv_field(const std::string& raw) {
  std::string text = printable(raw);
  if (!raw.empty() && kFormulaStarts.find(raw.front()) != kFormulaStarts.npos)
    text.insert(text.begin(), '\'');
  if (text.find_first_of(",\"") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace fieldcast
