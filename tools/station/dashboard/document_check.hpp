// Checks a JSON value against a row of dashboard_format.json and collects the faults. Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "tools/station/dashboard/dashboard_document.hpp"

namespace fieldcast::web {

class DocumentCheck {
 public:
  using Json = nlohmann::json;

  // `format`: the parsed dashboard_format.json. It must outlive this object.
  explicit DocumentCheck(const Json& format) : format_(format) {}

  void check_document(const Json& document);
  [[nodiscard]] DashboardFaults take_faults() { return std::move(faults_); }

 private:
  using Place = const std::string&;
  struct Type;
  static const Type kTypes[];

  void add_fault(Place place, std::string what, std::string allowed);
  void check(const Json& value, const Json& row, Place place);
  void check_members(const Json& object, const Json& rows, Place place);
  void check_more_members(const Json& object, const Json& rows, const Json& more, Place place);

  void check_name(const Json& value, const Json& row, Place place);
  void check_word(const Json& value, const Json& row, Place place);
  void check_text(const Json& value, const Json& row, Place place);
  void check_channel(const Json& value, const Json& row, Place place);
  void check_pattern(const Json& value, const Json& row, Place place);
  void check_number(const Json& value, const Json& row, Place place);
  void check_integer(const Json& value, const Json& row, Place place);
  void check_choice(const Json& value, const Json& row, Place place);
  void check_flag(const Json& value, const Json& row, Place place);
  void check_value(const Json& value, const Json& row, Place place);
  void check_address(const Json& value, const Json& row, Place place);
  void check_cells(const Json& value, const Json& row, Place place);
  void check_list(const Json& value, const Json& row, Place place);
  void check_object(const Json& value, const Json& row, Place place);
  void check_widget(const Json& value, const Json& row, Place place);

  void read_parameters(const Json& document);
  [[nodiscard]] std::string declared() const;
  // Replaces each ${name} by a letter. Empty after a fault.
  [[nodiscard]] std::optional<std::string> filled(std::string_view text, Place place);
  void check_overlaps(const Json& widgets);

  const Json& format_;
  std::vector<std::string> parameters_;  // names
  int columns_ = 12;
  DashboardFaults faults_;
};

}  // namespace fieldcast::web
