#include "tools/station/dashboard/document_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/message_text.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kShown = 60;  // bytes of a wrong value in a message
constexpr std::size_t kMaxWord = 64;
constexpr std::size_t kMaxPath = 200;
constexpr int kMaxRow = 500, kMaxHeight = 50;  // cells of the grid

std::string shown(const Json& value) {
  if (value.is_string())
    return '\'' + printable(value.get_ref<const std::string&>(), kShown) + '\'';
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return fmt::format("{}", value.get<double>());
  return fmt::format("this {}", value.type_name());  // "this object"
}

std::string member(const std::string& place, std::string_view name) {
  return place.empty() ? std::string(name) : fmt::format("{}.{}", place, name);
}

std::vector<std::string> names_of(const Json& rows) {
  std::vector<std::string> names;
  for (const Json& row : rows) names.push_back(row.at("name"));
  return names;
}

const Json* row_named(const Json& rows, const std::string& name) {
  const auto found =
      std::ranges::find_if(rows, [&](const Json& row) { return row.at("name") == name; });
  return found == rows.end() ? nullptr : &*found;
}

// A word of a channel's name: no separator, no pattern, no parameter.
bool is_word(std::string_view text) {
  if (text.empty() || text.size() > kMaxWord || !is_utf8(text)) return false;
  for (std::string_view left = text; !left.empty();) {
    const std::string_view character = left.substr(0, utf8_length(left));
    if (!is_printable(character) || std::string_view("/*$?&#{}").find(character) != text.npos)
      return false;
    left.remove_prefix(character.size());
  }
  return true;
}

std::string range_of(const Json& row, std::string_view kind) {
  if (row.contains("min") && row.contains("max"))
    return fmt::format("{} from {} to {}", kind, shown(row.at("min")), shown(row.at("max")));
  return std::string(kind);
}

bool in_range(const Json& value, const Json& row) {
  const auto number = value.get<double>();
  return std::isfinite(number) && number >= row.value("min", number) &&
         number <= row.value("max", number);
}

using Cells = std::array<int, 4>;  // column, row, width, height

std::optional<Cells> cells_of(const Json& value) {
  if (!value.is_array() || value.size() != 4) return std::nullopt;
  Cells cells{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (!value[i].is_number_integer()) return std::nullopt;
    const auto number = value[i].get<std::int64_t>();
    if (number < 0 || number > kMaxRow) return std::nullopt;
    cells[i] = static_cast<int>(number);
  }
  return cells;
}

bool overlap(const Cells& a, const Cells& b) {
  return a[0] < b[0] + b[2] && b[0] < a[0] + a[2] && a[1] < b[1] + b[3] && b[1] < a[1] + a[3];
}

}  // namespace

struct DocumentCheck::Type {
  std::string_view name;
  void (DocumentCheck::*check)(const Json& value, const Json& row, Place place);
};

const DocumentCheck::Type DocumentCheck::kTypes[] = {
    {"name", &DocumentCheck::check_name},       {"word", &DocumentCheck::check_word},
    {"text", &DocumentCheck::check_text},       {"channel", &DocumentCheck::check_channel},
    {"pattern", &DocumentCheck::check_pattern}, {"number", &DocumentCheck::check_number},
    {"integer", &DocumentCheck::check_integer}, {"choice", &DocumentCheck::check_choice},
    {"flag", &DocumentCheck::check_flag},       {"value", &DocumentCheck::check_value},
    {"address", &DocumentCheck::check_address}, {"cells", &DocumentCheck::check_cells},
    {"list", &DocumentCheck::check_list},       {"object", &DocumentCheck::check_object},
    {"widget", &DocumentCheck::check_widget},
};

void DocumentCheck::add_fault(Place place, std::string what, std::string allowed) {
  if (faults_.size() < kMaxDashboardFaults)
    faults_.push_back({place, std::move(what), std::move(allowed)});
}

void DocumentCheck::check_document(const Json& document) {
  read_parameters(document);
  check_members(document, format_.at("document"), "");
  if (document.contains("widgets")) check_overlaps(document.at("widgets"));
}

void DocumentCheck::check(const Json& value, const Json& row, Place place) {
  const std::string& type = row.at("type").get_ref<const std::string&>();
  const auto found = std::ranges::find(kTypes, std::string_view(type), &Type::name);
  (this->*found->check)(value, row, place);
}

void DocumentCheck::check_members(const Json& object, const Json& rows, Place place) {
  check_more_members(object, rows, Json::array(), place);
}

void DocumentCheck::check_more_members(const Json& object, const Json& rows, const Json& more,
                                       Place place) {
  if (!object.is_object()) return add_fault(place, shown(object) + " is not an object", "{...}");
  std::vector<std::string> known = names_of(rows);
  for (std::string& name : names_of(more)) known.push_back(std::move(name));
  for (const auto& [name, value] : object.items()) {
    const Json* row = row_named(rows, name);
    if (row == nullptr) row = row_named(more, name);
    if (row != nullptr)
      check(value, *row, member(place, name));
    else
      add_fault(member(place, printable(name, kShown)), "this property is unknown",
                fmt::format("known here: {}", fmt::join(known, ", ")));
  }
  for (const Json* table : {&rows, &more}) {
    for (const Json& row : *table) {
      if (row.value("required", false) && !object.contains(row.at("name")))
        add_fault(member(place, row.at("name").get<std::string>()), "this property is missing",
                  fmt::format("a {}", row.at("type").get<std::string>()));
    }
  }
}

void DocumentCheck::check_name(const Json& value, const Json&, Place place) {
  if (!value.is_string() || !is_dashboard_name(value.get_ref<const std::string&>()))
    add_fault(place, shown(value) + " is not a name",
              "1 to 64 of a-z, 0-9 and '-', the first not '-'");
}

void DocumentCheck::check_word(const Json& value, const Json&, Place place) {
  if (!value.is_string() || !is_word(value.get_ref<const std::string&>()))
    add_fault(place, shown(value) + " is not a word",
              "1 to 64 bytes without / * $ ? & # { }; a parameter cannot contain a parameter");
}

void DocumentCheck::check_text(const Json& value, const Json& row, Place place) {
  const auto most = row.at("max").get<std::size_t>();
  if (!value.is_string() || value.get_ref<const std::string&>().size() > most)
    return add_fault(place, shown(value) + " is not a text of this length",
                     fmt::format("at most {} bytes", most));
  (void)filled(value.get_ref<const std::string&>(), place);
}

void DocumentCheck::check_channel(const Json& value, const Json&, Place place) {
  const auto text = value.is_string() && value.get_ref<const std::string&>().size() <= kMaxPath
                        ? filled(value.get_ref<const std::string&>(), place)
                        : std::optional<std::string>("");
  if (text && !ChannelPath::parse(*text))
    add_fault(place, shown(value) + " is not a channel",
              "BUS/DEVICE/CHANNEL, for example press-shop/press-1/speed");
}

void DocumentCheck::check_pattern(const Json& value, const Json&, Place place) {
  const auto text = value.is_string() && value.get_ref<const std::string&>().size() <= kMaxPath
                        ? filled(value.get_ref<const std::string&>(), place)
                        : std::optional<std::string>("");
  if (text && (text->empty() || !Pattern::parse(*text)))
    add_fault(place, shown(value) + " is not a pattern of channels",
              "BUS/DEVICE/CHANNEL with *, for example press-shop/*/speed");
}

void DocumentCheck::check_number(const Json& value, const Json& row, Place place) {
  if (!value.is_number() || !in_range(value, row))
    add_fault(place, shown(value) + " is not allowed", range_of(row, "a number"));
}

void DocumentCheck::check_integer(const Json& value, const Json& row, Place place) {
  if (!value.is_number_integer() || !in_range(value, row))
    add_fault(place, shown(value) + " is not allowed", range_of(row, "an integer"));
}

void DocumentCheck::check_choice(const Json& value, const Json& row, Place place) {
  const Json& choices = row.at("choices");
  if (std::ranges::find(choices, value) == choices.end())
    add_fault(place, shown(value) + " is not allowed",
              fmt::format("one of {}", fmt::join(choices.get<std::vector<std::string>>(), ", ")));
}

void DocumentCheck::check_flag(const Json& value, const Json&, Place place) {
  if (!value.is_boolean()) add_fault(place, shown(value) + " is not allowed", "true or false");
}

void DocumentCheck::check_value(const Json& value, const Json&, Place place) {
  if (value.is_string() && value.get_ref<const std::string&>().size() <= kMaxPath)
    (void)filled(value.get_ref<const std::string&>(), place);
  else if (!value.is_number() && !value.is_boolean())
    add_fault(place, shown(value) + " is not a value",
              fmt::format("a number, true, false, or a text of at most {} bytes", kMaxPath));
}

// NAME or NAME?parameter=value&parameter=value: a dashboard of this station.
void DocumentCheck::check_address(const Json& value, const Json&, Place place) {
  const bool fits = value.is_string() && value.get_ref<const std::string&>().size() <= kMaxPath;
  const auto text =
      fits ? filled(value.get_ref<const std::string&>(), place) : std::optional<std::string>("");
  if (!text) return;
  const std::size_t query = std::min(text->find('?'), text->size());
  bool valid = is_dashboard_name(std::string_view(*text).substr(0, query));
  for (std::size_t at = query; at < text->size();) {
    const std::size_t end = std::min(text->find('&', at + 1), text->size());
    const std::string_view pair = std::string_view(*text).substr(at + 1, end - at - 1);
    const std::size_t equals = std::min(pair.find('='), pair.size());
    valid = valid && is_dashboard_name(pair.substr(0, equals)) && equals < pair.size() &&
            is_word(pair.substr(equals + 1));
    at = end;
  }
  if (!valid)
    add_fault(place, shown(value) + " is not an address of a dashboard",
              "NAME, or NAME?parameter=value&parameter=value");
}

void DocumentCheck::check_cells(const Json& value, const Json&, Place place) {
  const auto cells = cells_of(value);
  if (!cells || (*cells)[2] < 1 || (*cells)[3] < 1 || (*cells)[3] > kMaxHeight ||
      (*cells)[0] + (*cells)[2] > columns_)
    add_fault(place, shown(value) + " is not a place on the grid",
              fmt::format("[column, row, width, height]: column + width at most {}, row at most "
                          "{}, height 1 to {}",
                          columns_, kMaxRow, kMaxHeight));
}

void DocumentCheck::check_list(const Json& value, const Json& row, Place place) {
  if (!value.is_array() || value.size() < row.value("min", std::size_t{0}) ||
      value.size() > row.at("max").get<std::size_t>())
    return add_fault(place,
                     value.is_array() ? fmt::format("the list has {} items", value.size())
                                      : shown(value) + " is not a list",
                     fmt::format("a list of {} to {} items", row.value("min", 0),
                                 row.at("max").get<std::size_t>()));
  for (std::size_t i = 0; i < value.size(); ++i)
    check(value[i], row.at("of"), fmt::format("{}[{}]", place, i));
}

void DocumentCheck::check_object(const Json& value, const Json& row, Place place) {
  check_members(value, row.at("of"), place);
}

void DocumentCheck::check_widget(const Json& value, const Json&, Place place) {
  const Json& kinds = format_.at("kinds");
  const Json kind = value.is_object() ? value.value("kind", Json()) : Json();
  if (!kind.is_string() || !kinds.contains(kind.get<std::string>())) {
    std::vector<std::string> known;
    for (const auto& [name, row] : kinds.items()) known.push_back(name);
    return add_fault(member(place, "kind"), shown(kind) + " is not a kind of widget",
                     fmt::format("one of {}", fmt::join(known, ", ")));
  }
  Json common = format_.at("widget");
  common[0]["choices"] = Json::array({kind});
  check_more_members(value, common, kinds.at(kind.get<std::string>()).at("properties"), place);
  if (value.contains("min") && value.contains("max") && value.at("min").is_number() &&
      value.at("max").is_number() && value.at("min") >= value.at("max"))
    add_fault(member(place, "max"), shown(value.at("max")) + " is not above min",
              "a number above " + shown(value.at("min")));
}

// Reads the declared parameters and the columns first: the other properties refer to them.
void DocumentCheck::read_parameters(const Json& document) {
  const auto found = document.find("parameters");
  if (found != document.end() && found->is_array()) {
    for (std::size_t i = 0; i < found->size(); ++i) {
      const Json& one = (*found)[i];
      if (!one.is_object() || !one.contains("name") || !one.at("name").is_string()) continue;
      const auto name = one.at("name").get<std::string>();
      const std::string place = fmt::format("parameters[{}]", i);
      if (std::ranges::find(parameters_, name) != parameters_.end())
        add_fault(member(place, "name"), shown(name) + " is declared twice", "each name once");
      parameters_.push_back(name);
      const Json values = one.value("values", Json::array());
      if (!values.empty() && one.contains("default") &&
          std::ranges::find(values, one.at("default")) == values.end())
        add_fault(member(place, "default"), shown(one.at("default")) + " is not in values",
                  "one of its values");
    }
  }
  const auto grid = document.find("grid");
  if (grid == document.end() || !grid->is_object()) return;
  const auto columns = grid->find("columns");
  if (columns != grid->end() && columns->is_number_integer() && columns->get<std::int64_t>() >= 1 &&
      columns->get<std::int64_t>() <= 24)
    columns_ = columns->get<int>();
}

std::string DocumentCheck::declared() const {
  return parameters_.empty() ? "this dashboard declares no parameters"
                             : fmt::format("declared parameters: {}", fmt::join(parameters_, ", "));
}

std::optional<std::string> DocumentCheck::filled(std::string_view text, Place place) {
  std::string result;
  for (std::size_t open = 0; (open = text.find("${")) != text.npos;) {
    const std::size_t close = text.find('}', open);
    const std::string name(text.substr(open + 2, close - open - 2));
    if (close == text.npos || std::ranges::find(parameters_, name) == parameters_.end()) {
      add_fault(place, "'${" + printable(name, kShown) + "}' is not a parameter", declared());
      return std::nullopt;
    }
    result.append(text.substr(0, open)).append("x");
    text.remove_prefix(close + 1);
  }
  return result.append(text);
}

void DocumentCheck::check_overlaps(const Json& widgets) {
  std::vector<std::pair<std::size_t, Cells>> placed;
  for (std::size_t i = 0; widgets.is_array() && i < widgets.size(); ++i) {
    if (!widgets[i].is_object()) continue;
    const auto cells = cells_of(widgets[i].value("at", Json()));
    if (!cells) continue;
    for (const auto& [other, at] : placed) {
      if (!overlap(*cells, at)) continue;
      add_fault(fmt::format("widgets[{}].at", i),
                fmt::format("the widget covers widgets[{}]", other),
                "a place that no other widget has");
      break;
    }
    placed.emplace_back(i, *cells);
  }
}

}  // namespace fieldcast::web
