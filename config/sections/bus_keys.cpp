#include "config/sections/bus_keys.hpp"

#include <fmt/format.h>

#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bus.hpp"
#include "config/sections/capture.hpp"
#include "config/sections/device_keys.hpp"
#include "config/sections/port.hpp"

namespace fieldcast::config {
namespace {

constexpr std::pair<std::string_view, Planner> kPlanners[] = {{"cyclic", Planner::kCyclic},
                                                              {"dynamic", Planner::kDynamicBlocks}};
constexpr std::pair<std::string_view, std::optional<bool>> kEchoes[] = {
    {"auto", std::nullopt}, {"true", true}, {"false", false}};

std::vector<Field<BusSpec>> bus_fields() {
  return {
      field<BusSpec>({.name = "name",
                      .fallback = "needed",
                      .text = "unique in the DDS domain: of two bridges with a bus of one name the "
                              "later one does not serve it",
                      .example = "a name for the bus"},
                     &BusSpec::name, NameRule{}),
      {{.name = "port",
        .fallback = "needed",
        .text = "see below",
        .schema = R"({ "$ref": "#/$defs/port" })"}},
      {{.name = "protocol",
        .fallback = "needed, unless every device names its own",
        .text = protocol_names() + ", or the name of a [declared protocol](protocols/README.md)",
        .schema = R"({ "$ref": "#/$defs/protocol" })"}},
      field<BusSpec>(
          {.name = "planner",
           .fallback = "cyclic",
           .text = "how requests are formed: `cyclic` makes groups that are read in a "
                   "cyclic schedule; `dynamic` reads the most urgent channel with its "
                   "near neighbours, again and again, at most 20 blocks, and then those"},
          &BusSpec::planner, ChoiceRule<Planner>{kPlanners}),
      {{.name = "capture",
        .fallback = "only when somebody asks",
        .text = "keeps what passes on the wire, for Wireshark, see below",
        .schema = R"({ "$ref": "#/$defs/capture" })"}},
      {{.name = "defaults",
        .fallback = "none",
        .text = "every key marked ●, `silence`, `gap-allowance`",
        .schema = R"({ "$ref": "#/$defs/bus-defaults" })"}},
      field<BusSpec>({.name = "echo",
                      .fallback = "auto",
                      .text = "the line gives back what is sent; `auto` finds out"},
                     &BusSpec::echo, ChoiceRule<std::optional<bool>>{kEchoes}),
      {{.name = "devices",
        .fallback = "needed",
        .text = fmt::format("1 to {} devices", kMaxDevices),
        .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                  std::to_string(kMaxDevices) + R"(, "items": { "$ref": "#/$defs/device" } })"}},
  };
}

std::vector<Field<BusDefaults>> bus_default_fields() {
  std::vector<Field<BusDefaults>> rows;
  const auto devices = [](BusDefaults& both) -> DeviceDefaults& { return both.devices; };
  const auto& below = device_rows().fields();
  // Options and rights are last in the documents.
  std::vector<Field<DeviceDefaults>> first, last;
  for (const auto& each : below)
    (each.key.name == "options" || each.key.name == "allow" ? last : first).push_back(each);
  append_flowing(rows, first, devices);
  append_flowing(rows, last, devices);
  rows.push_back(field<BusDefaults>(
      {.name = "silence",
       .fallback = "standard: 3.5 characters, 1.75 ms above 19200 baud",
       .text = "between a response and the next request: `standard`, characters as `3.5c`, or a "
               "duration"},
      [](BusDefaults& both) -> SilenceRule& { return both.bus.silence; }, SilenceReader{}));
  rows.push_back(field<BusDefaults>(
      {.name = "gap-allowance",
       .fallback = "20ms",
       .text = "silence inside a response that ends it"},
      [](BusDefaults& both) -> Duration& { return both.bus.gap_allowance; },
      DurationRule{Duration{}, kMaxSilence}));
  return rows;
}

}  // namespace

const Rows<BusSpec>& bus_rows() {
  static const Rows<BusSpec> rows("bus", "a bus", bus_fields());
  return rows;
}

const Rows<CaptureSpec>& capture_rows() {
  static const Rows<CaptureSpec> rows(
      "capture", "'capture' of a bus",
      {
          field<CaptureSpec>({.name = "folder",
                              .fallback = "needed",
                              .text = "an existing folder, relative to this file; the names of the "
                                      "files are bus and time",
                              .example = "an existing folder"},
                             &CaptureSpec::folder, TextRule{kMaxPath}),
          field<CaptureSpec>({.name = "file-size",
                              .fallback = "10MB",
                              .text = "of one file, then the next begins"},
                             &CaptureSpec::file_bytes, CaptureSizeRule{}),
          field<CaptureSpec>({.name = "files",
                              .fallback = "10",
                              .text = "how many are kept; beyond it the oldest goes"},
                             &CaptureSpec::files, WholeRule{2, kMaxCaptureFiles}),
      },
      "Files of a capture, one after the other: [docs/wireshark.md](../docs/wireshark.md).");
  return rows;
}

const Rows<BusDefaults>& bus_default_rows() {
  static const Rows<BusDefaults> rows("bus-defaults", "'defaults' of a bus", bus_default_fields());
  return rows;
}

}  // namespace fieldcast::config
