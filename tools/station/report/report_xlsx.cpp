#include "tools/station/report/report_xlsx.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <xlsxwriter.h>

#include <cerrno>
#include <ctime>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxCell = 256;  // bytes of a name
constexpr lxw_row_t kHead = 0;

struct Formats {
  lxw_format *head, *time, *share;
};

Formats formats_of(lxw_workbook* book) {
  const Formats formats{workbook_add_format(book), workbook_add_format(book),
                        workbook_add_format(book)};
  format_set_bold(formats.head);
  format_set_num_format(formats.time, "yyyy-mm-dd hh:mm");
  format_set_num_format(formats.share, "0.0%");
  return formats;
}

void write_time(lxw_worksheet* sheet, lxw_row_t row, lxw_col_t column, UtcTime at,
                lxw_format* format) {
  const std::tm local = local_parts(at);
  lxw_datetime cell{local.tm_year + 1900, local.tm_mon + 1, local.tm_mday,
                    local.tm_hour,        local.tm_min,     0};
  worksheet_write_datetime(sheet, row, column, &cell, format);
}

void write_text(lxw_worksheet* sheet, lxw_row_t row, lxw_col_t column, const std::string& text) {
  worksheet_write_string(sheet, row, column, printable(text, kMaxCell).c_str(), nullptr);
}

void write_row(lxw_worksheet* sheet, lxw_row_t at, const ReportTable& table, const ReportRow& row,
               const Formats& formats) {
  write_text(sheet, at, 0, table.channel);
  write_text(sheet, at, 1, table.unit);
  write_time(sheet, at, 2, row.period.from, formats.time);
  write_time(sheet, at, 3, row.period.to, formats.time);
  lxw_col_t column = 4;
  for (const auto& number : {row.min, row.mean, row.max, row.integral}) {
    if (number) worksheet_write_number(sheet, at, column, *number, nullptr);
    ++column;
  }
  worksheet_write_number(sheet, at, column, row.covered, formats.share);
}

void write_sheet(lxw_worksheet* sheet, const std::vector<ReportTable>& tables,
                 const Formats& formats) {
  lxw_col_t column = 0;
  for (const char* name : kReportColumns)
    worksheet_write_string(sheet, kHead, column++, name, formats.head);
  worksheet_freeze_panes(sheet, kHead + 1, 0);
  worksheet_set_column(sheet, 0, 0, 32, nullptr);
  worksheet_set_column(sheet, 2, 3, 17, nullptr);
  worksheet_set_column(sheet, 4, 7, 13, nullptr);
  lxw_row_t at = kHead + 1;
  for (const ReportTable& table : tables) {
    for (const ReportRow& row : table.rows) write_row(sheet, at++, table, row, formats);
  }
}

tl::expected<std::string, std::string> content_of(int file) {
  struct stat found {};
  if (::fstat(file, &found) != 0) return tl::make_unexpected(errno_text(errno));
  std::string bytes(static_cast<std::size_t>(found.st_size), '\0');
  const ssize_t count = ::pread(file, bytes.data(), bytes.size(), 0);
  if (count < 0) return tl::make_unexpected(errno_text(errno));
  bytes.resize(static_cast<std::size_t>(count));
  return bytes;
}

}  // namespace

tl::expected<std::string, std::string> report_xlsx(const std::vector<ReportTable>& tables) {
  // The library of Debian 12 writes to a file by its name only.
  const FileDescriptor memory(::memfd_create("report", MFD_CLOEXEC));
  if (!memory) return tl::make_unexpected(errno_text(errno));
  lxw_workbook* const book = workbook_new(fmt::format("/proc/self/fd/{}", memory.get()).c_str());
  if (book == nullptr) return tl::make_unexpected(errno_text(ENOMEM));
  write_sheet(workbook_add_worksheet(book, "report"), tables, formats_of(book));
  if (const lxw_error error = workbook_close(book); error != LXW_NO_ERROR)
    return tl::make_unexpected(std::string(lxw_strerror(error)));
  return content_of(memory.get());
}

}  // namespace fieldcast::web
