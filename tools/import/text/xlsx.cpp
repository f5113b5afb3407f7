// A workbook is a zip archive of XML. Supports texts, numbers and booleans of one sheet (ECMA-376,
// part 1, 18.3).
#include <tinyxml2.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

class Archive {
 public:
  explicit Archive(std::string_view bytes) {
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
    if (source == nullptr) return;
    archive_ = zip_open_from_source(source, ZIP_RDONLY, nullptr);
    if (archive_ == nullptr) zip_source_free(source);
  }
  ~Archive() {
    if (archive_ != nullptr) zip_discard(archive_);
  }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  [[nodiscard]] bool is_open() const { return archive_ != nullptr; }

  [[nodiscard]] bool has(const std::string& name) const {
    return zip_name_locate(archive_, name.c_str(), 0) >= 0;
  }
  [[nodiscard]] std::optional<std::string> part(const std::string& name) const {
    zip_stat_t stat;
    if (zip_stat(archive_, name.c_str(), 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0 ||
        stat.size > kMaxUnpacked)
      return std::nullopt;
    zip_file_t* file = zip_fopen(archive_, name.c_str(), 0);
    if (file == nullptr) return std::nullopt;
    std::string text(stat.size, '\0');
    const zip_int64_t got = zip_fread(file, text.data(), text.size());
    zip_fclose(file);
    if (got < 0 || static_cast<std::size_t>(got) != text.size()) return std::nullopt;
    return text;
  }

  [[nodiscard]] std::string first_sheet() const {
    std::string best;
    for (zip_int64_t i = 0; i < zip_get_num_entries(archive_, 0); ++i) {
      const char* name = zip_get_name(archive_, static_cast<zip_uint64_t>(i), 0);
      if (name == nullptr || !std::string_view(name).starts_with("xl/worksheets/sheet")) continue;
      const std::string_view text = name;
      if (best.empty() || text.size() < best.size() || (text.size() == best.size() && text < best))
        best = text;
    }
    return best;
  }

 private:
  zip_t* archive_ = nullptr;
};

std::string text_below(const tinyxml2::XMLElement& element) {
  std::string text;
  for (const auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (std::strcmp(child->Name(), "t") == 0) {
      if (child->GetText() != nullptr) text += child->GetText();
    } else if (std::strcmp(child->Name(), "r") == 0) {
      text += text_below(*child);
    }
  }
  return text;
}

using Document = tinyxml2::XMLDocument;

Result<std::unique_ptr<Document>> read_part(const Archive& archive, const std::string& name) {
  const auto part = archive.part(name);
  auto document = std::make_unique<Document>();
  if (!part || document->Parse(part->data(), part->size()) != tinyxml2::XML_SUCCESS ||
      document->RootElement() == nullptr)
    return refused("an Excel workbook whose part {} is damaged or larger than {} MiB", name,
                   kMaxUnpacked >> 20);
  return document;
}

// Workbooks with numbers only have none.
Result<std::vector<std::string>> shared_texts(const Archive& archive) {
  static const std::string kPart = "xl/sharedStrings.xml";
  std::vector<std::string> texts;
  if (!archive.has(kPart)) return texts;
  const auto document = read_part(archive, kPart);
  if (!document) return tl::unexpected(document.error());
  for (const auto* item = (*document)->RootElement()->FirstChildElement("si"); item != nullptr;
       item = item->NextSiblingElement("si"))
    texts.push_back(text_below(*item));
  return texts;
}

// "AB12" is in column 27, counted from 0.
std::size_t column_of(const char* reference, std::size_t otherwise) {
  if (reference == nullptr) return otherwise;
  std::size_t column = 0;
  for (; *reference >= 'A' && *reference <= 'Z' && column < 100'000; ++reference)
    column = column * 26 + static_cast<std::size_t>(*reference - 'A' + 1);
  return column == 0 ? otherwise : column - 1;
}

std::string cell_text(const tinyxml2::XMLElement& cell, const std::vector<std::string>& shared) {
  const char* type = cell.Attribute("t");
  const std::string_view kind = type == nullptr ? "n" : type;
  if (const auto* inside = cell.FirstChildElement("is")) return text_below(*inside);
  const auto* value = cell.FirstChildElement("v");
  const std::string text = value == nullptr || value->GetText() == nullptr ? "" : value->GetText();
  if (kind == "s") {
    const auto index = whole_from(text);
    return index && *index < shared.size() ? shared[*index] : std::string();
  }
  if (kind == "b") return text == "1" ? "true" : "false";
  return text;
}

void append_cell(std::string& table, std::string_view text) {
  if (text.find_first_of("\t\n\r\"") == std::string_view::npos) {
    table += text;
    return;
  }
  table += '"';
  for (const char c : text) {
    if (c == '"') table += '"';
    table += c;
  }
  table += '"';
}

// Empty if the table exceeds kMaxUnpacked; many cells may refer to one long text.
std::optional<std::string> table_of(const tinyxml2::XMLElement& sheet,
                                    const std::vector<std::string>& shared) {
  std::string table;
  std::size_t line = 1;
  const auto* data = sheet.FirstChildElement("sheetData");
  for (const auto* row = data == nullptr ? nullptr : data->FirstChildElement("row"); row != nullptr;
       row = row->NextSiblingElement("row")) {
    // Keeps the sheet's row as the line number of the text.
    const std::size_t number = row->UnsignedAttribute("r", static_cast<unsigned>(line));
    for (; line < std::min<std::size_t>(number, kMaxRows); ++line) table += '\n';
    std::size_t column = 0;
    for (const auto* cell = row->FirstChildElement("c"); cell != nullptr;
         cell = cell->NextSiblingElement("c"), ++column) {
      const std::size_t wanted = column_of(cell->Attribute("r"), column);
      if (wanted >= kMaxCells) break;
      for (; column < wanted; ++column) table += '\t';
      append_cell(table, cell_text(*cell, shared));
      table += '\t';
      if (table.size() > kMaxUnpacked) return std::nullopt;
    }
    table += '\n';
    ++line;
  }
  return table;
}

}  // namespace

bool is_xlsx(std::string_view bytes) { return bytes.starts_with("PK\x03\x04"); }

Result<Decoded> table_of_xlsx(std::string_view bytes) {
  const Archive archive(bytes);
  if (!archive.is_open()) return refused("a zip archive that is damaged");
  const std::string name = archive.first_sheet();
  if (name.empty()) return refused("a zip archive, no Excel workbook; unpack it first");
  const auto sheet = read_part(archive, name);
  if (!sheet) return tl::unexpected(sheet.error());
  const auto shared = shared_texts(archive);
  if (!shared) return tl::unexpected(shared.error());
  auto table = table_of(*(*sheet)->RootElement(), *shared);
  if (!table)
    return refused("an Excel workbook whose sheet has more than {} MiB of text",
                   kMaxUnpacked >> 20);
  return Decoded{*std::move(table), "Excel workbook"};
}

}  // namespace fieldcast::importing
