#include "tools/import/xlsx.hpp"

namespace fieldcast::importing {

bool is_xlsx(std::string_view bytes) { return bytes.starts_with("PK\x03\x04"); }

tl::expected<Decoded, std::string> table_of_xlsx(std::string_view) {
  return tl::unexpected(std::string("an Excel workbook or another archive; save the sheet as CSV"));
}

}  // namespace fieldcast::importing
