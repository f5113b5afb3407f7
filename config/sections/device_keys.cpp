#include "config/sections/device_keys.hpp"

#include "config/channel/channel_keys.hpp"
#include "config/document/common_forms.hpp"
#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/program.hpp"

namespace fieldcast::config {
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
      device_row({.name = "timeout",
                  .fallback = "200ms",
                  .text = "to the first byte of a response",
                  .flows_down = true},
                 &DeviceSpec::timeout, DurationRule{kMinTimeout, kMaxTimeout}),
      device_row({.name = "retries",
                  .fallback = "1",
                  .text = "more tries of an exchange",
                  .flows_down = true},
                 &DeviceSpec::retries, WholeRule{0, kMaxRetries}),
      device_row({.name = "pause",
                  .fallback = "0ms",
                  .text = "rest after each exchange with the device",
                  .flows_down = true},
                 &DeviceSpec::pause, DurationRule{Duration{}, kMaxPause}),
      device_row({.name = "max-block",
                  .fallback = "the protocol's limit",
                  .text = "items in one read, for weak devices",
                  .flows_down = true},
                 &DeviceSpec::max_block, WholeRule{1, 65535}),
      device_row({.name = "max-gap",
                  .fallback = "whatever pays",
                  .text = "unwanted items that a read may bridge",
                  .flows_down = true},
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
           .text = "commands to addresses that are no channels",
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
        .text = "on the bus; the protocol narrows it",
        .schema = WholeRule{0, 65535}.schema()}},
      device_row(
          {.name = "number",
           .fallback = "not programmed",
           .text = "under which engineers ask for the device, to program it through its bus; the "
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
