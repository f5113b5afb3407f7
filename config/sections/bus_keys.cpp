#include "config/sections/bus_keys.hpp"

#include <fmt/format.h>

#include "config/channel/channel_keys.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bus.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program.hpp"

namespace fieldcast::config {

namespace {

constexpr std::pair<std::string_view, Planner> kPlanners[] = {{"cyclic", Planner::kCyclic},
                                                              {"dynamic", Planner::kDynamicBlocks}};
constexpr std::pair<std::string_view, std::optional<bool>> kEchoes[] = {
    {"auto", std::nullopt}, {"true", true}, {"false", false}};

constexpr std::pair<std::string_view, std::int64_t> kFileUnits[] = {
    {"kB", 1'000}, {"MB", 1'000'000}, {"GB", 1'000'000'000}};
constexpr SizeRule kFileSize{.min = 100'000,
                             .max = 1'000'000'000'000,
                             .range = "100kB to 1000GB",
                             .allowed = "100kB to 1000GB, with kB, MB or GB",
                             .pattern = "[0-9]+(kB|MB|GB)",
                             .units = kFileUnits};

std::vector<Field<BusSpec>> bus_fields() {
  return {
      field({.name = "name",
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
      field({"planner", "cyclic",
             "how requests are formed: `cyclic` makes groups that are read in a "
             "cyclic schedule; `dynamic` reads the most urgent channel with its "
             "near neighbours, again and again, at most 20 blocks, and then those"},
            &BusSpec::planner, ChoiceRule<Planner>{kPlanners}),
      {{.name = "capture",
        .fallback = "only when somebody asks",
        .text = "keeps what passes on the wire, for Wireshark, see below",
        .schema = R"({ "$ref": "#/$defs/capture" })"}},
      {{.name = "gateway",
        .fallback = "none: nothing listens",
        .text = "where Modbus TCP clients read and write the devices, see below",
        .schema = R"({ "$ref": "#/$defs/gateway" })"}},
      {{.name = "defaults",
        .fallback = "none",
        .text = "every key marked ●, `silence`, `gap-allowance`",
        .schema = R"({ "$ref": "#/$defs/bus-defaults" })"}},
      field({"echo", "auto", "the line gives back what is sent; `auto` finds out"}, &BusSpec::echo,
            ChoiceRule<std::optional<bool>>{kEchoes}),
      field({"in-flight", "1",
             "requests that wait for their responses at the same time, on a TCP connection with " +
                 pipelined_protocol_names() + "; fewer if the device drops requests"},
            &BusSpec::in_flight, WholeRule{1, kMaxInFlight}),
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
      {"silence", "standard: 3.5 characters, 1.75 ms above 19200 baud",
       "between a response and the next request: `standard`, characters as `3.5c`, a duration, or "
       "`learn` ([below](#learned-silence)), with the shortest permitted one as `learn 1ms`"},
      [](BusDefaults& both) -> SilenceRule& { return both.bus.silence; }, SilenceReader{}));
  rows.push_back(field<BusDefaults>(
      {"gap-allowance", "20ms", "silence inside a response that ends it"},
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
          field({.name = "folder",
                 .fallback = "needed",
                 .text = "an existing folder, relative to this file; the names of the "
                         "files are bus and time",
                 .example = "an existing folder"},
                &CaptureSpec::folder, TextRule{kMaxPath}),
          field({"file-size", "10MB", "of one file, then the next begins"},
                &CaptureSpec::file_bytes, kFileSize),
          field({"files", "10", "how many are kept; beyond it the oldest goes"},
                &CaptureSpec::files, WholeRule{2, kMaxCaptureFiles}),
          field({"only-sessions", "false",
                 "only the bytes of programming sessions are written, in both directions"},
                &CaptureSpec::only_sessions, FlagRule{}),
      },
      "Files of a capture, one after the other: [docs/wireshark.md](../docs/wireshark.md).");
  return rows;
}

const Rows<BusDefaults>& bus_default_rows() {
  static const Rows<BusDefaults> rows("bus-defaults", "'defaults' of a bus", bus_default_fields());
  return rows;
}

namespace {

using DeviceRow = Field<DeviceDefaults>;

template <typename T, typename Rule>
DeviceRow device_row(Key key, T DeviceSpec::*member, Rule rule) {
  return field<DeviceDefaults>(
      std::move(key), [member](DeviceDefaults& device) -> T& { return device.spec.*member; }, rule);
}

std::vector<DeviceRow> device_defaults() {
  std::vector<DeviceRow> rows;
  append_flowing(rows, channel_rows().fields(), &DeviceDefaults::channels);
  const std::vector<DeviceRow> own{
      device_row({"timeout", "200ms", "to the first byte of a response", kFlowsDown},
                 &DeviceSpec::timeout, DurationRule{kMinTimeout, kMaxTimeout}),
      device_row({"retries", "1", "more tries of an exchange", kFlowsDown}, &DeviceSpec::retries,
                 WholeRule{0, kMaxRetries}),
      device_row({"pause", "0ms", "rest after each exchange with the device", kFlowsDown},
                 &DeviceSpec::pause, DurationRule{Duration{}, kMaxPause}),
      device_row(
          {"max-block", "the protocol's limit", "items in one read, for weak devices", kFlowsDown},
          &DeviceSpec::max_block, WholeRule{1, 65535}),
      device_row({"max-gap", "whatever pays", "unwanted items that a read may bridge", kFlowsDown},
                 &DeviceSpec::max_gap, WholeRule{0, 65535}),
  };
  rows.insert(rows.end(), own.begin(), own.end());
  return rows;
}

DeviceRow options_row() {
  return {{.name = "options",
           .fallback = "none",
           .text = "of the protocol. " + options_text(),
           .flows_down = true,
           .schema = R"({ "$ref": "#/$defs/options" })"},
          read_options};
}
DeviceRow allow_row() {
  return {{.name = "allow",
           .fallback = "none",
           .text = "commands to addresses, without the access and the limits of channels",
           .flows_down = true,
           .schema = R"({ "$ref": "#/$defs/allow" })",
           .form = "`[raw-read, raw-write]`"},
          read_allow};
}
DeviceRow channels_row(std::string fallback) {
  return {{.name = "channels",
           .fallback = std::move(fallback),
           .text = "a list, or the name of a CSV file",
           .schema = R"({ "$ref": "#/$defs/channels" })"}};
}

std::vector<DeviceRow> device_fields() {
  std::vector<DeviceRow> rows{
      device_row({.name = "name",
                  .fallback = "needed",
                  .text = "unique on the bus",
                  .example = "a name for the device"},
                 &DeviceSpec::name, NameRule{}),
      {{.name = "address",
        .fallback = "needed",
        .text = "on the bus; the protocol narrows it. A declared protocol can have longer numbers "
                "(\"004712345678\") or texts",
        .schema = R"({ "anyOf": [{ "type": "integer", "minimum": 0 }, { "type": "string", )"
                  R"("minLength": 1, "maxLength": 64 }] })"}},
      device_row({"number", "not programmed",
                  "under which engineers ask for the device, to program it through its bus; the "
                  "devices of a `dial-in` bus are reached by that number as it is"},
                 &DeviceSpec::number, DeviceNumberRule{}),
      {{.name = "protocol",
        .fallback = "the bus's",
        .text = "another than the bus's",
        .schema = R"({ "$ref": "#/$defs/protocol" })"}},
      {{.name = "template",
        .fallback = "none",
        .text = "NAME of a kind of device: devices/NAME.yaml beside this file, or one that comes "
                "with Fieldcast",
        .schema = R"({ "$ref": "#/$defs/word" })"}},
      channels_row("needed without `template` and `allow`"),
      options_row(),
      allow_row(),
  };
  const auto below = device_defaults();
  rows.insert(rows.end(), below.begin(), below.end());
  return rows;
}

}  // namespace

const Rows<DeviceDefaults>& device_rows() {
  static const Rows<DeviceDefaults> rows("device", "a device", device_fields());
  return rows;
}

const Rows<DeviceDefaults>& template_default_rows() {
  static const Rows<DeviceDefaults> rows("template-defaults", "'defaults' of a template",
                                         device_defaults());
  return rows;
}

const Rows<DeviceDefaults>& template_rows() {
  static const Rows<DeviceDefaults> rows(
      "template", "a device template",
      {
          {{.name = "description",
            .fallback = "none",
            .text = "shown to users",
            .schema = TextRule{kMaxDescription}.schema()}},
          {{.name = "protocols",
            .fallback = "any",
            .text = "those whose notation the channels are written in; another is a fault",
            .schema =
                R"({ "type": "array", "minItems": 1, "items": { "$ref": "#/$defs/protocol" } })"}},
          {{.name = "defaults",
            .fallback = "none",
            .text = "every key marked ●",
            .schema = R"({ "$ref": "#/$defs/template-defaults" })"}},
          options_row(),
          allow_row(),
          channels_row("none"),
      });
  return rows;
}

}  // namespace fieldcast::config
