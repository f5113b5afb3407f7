#include "config/keys.hpp"

#include <algorithm>
#include <array>

namespace fieldcast::config {
namespace {

constexpr std::string_view kBridge[] = {"bridge", "dds", "log", "store", "program", "buses"};
constexpr std::string_view kDds[] = {"domain", "interfaces", "discovery-server", "profile",
                                     "partition"};
constexpr std::string_view kLog[] = {"level"};
constexpr std::string_view kProgram[] = {"engineers", "modules"};
constexpr std::string_view kEngineers[] = {"listen", "certificate", "key",
                                           "login",  "heartbeat",   "idle"};
constexpr std::string_view kModules[] = {"listen", "ask",   "prefix", "unit",
                                         "first",  "words", "timeout"};
constexpr std::string_view kStore[] = {"path", "url", "samples", "keep", "max-size"};
constexpr std::string_view kBus[] = {"name",     "port", "protocol", "planner",
                                     "defaults", "echo", "devices"};
constexpr std::string_view kPort[] = {"serial",      "tcp",       "dial-in",
                                      "baud",        "format",    "rs485",
                                      "low-latency", "exclusive", "connect-timeout"};
constexpr std::string_view kBusDefaults[] = {
    "refresh",    "mode",     "access",    "acquire", "priority",     "elasticity", "word-order",
    "byte-order", "encoding", "heartbeat", "timeout", "retries",      "pause",      "max-block",
    "max-gap",    "options",  "allow",     "silence", "gap-allowance"};
constexpr std::string_view kTemplateDefaults[] = {
    "refresh",    "mode",       "access",     "acquire",   "priority",
    "elasticity", "word-order", "byte-order", "encoding",  "heartbeat",
    "timeout",    "retries",    "pause",      "max-block", "max-gap"};
constexpr std::string_view kDevice[] = {
    "name",     "address",    "number",     "protocol",   "template", "channels",
    "options",  "allow",      "refresh",    "mode",       "access",   "acquire",
    "priority", "elasticity", "word-order", "byte-order", "encoding", "heartbeat",
    "timeout",  "retries",    "pause",      "max-block",  "max-gap"};
constexpr std::string_view kChannel[] = {
    "name",    "at",         "type",       "refresh",  "mode",        "access",
    "acquire", "priority",   "elasticity", "unit",     "description", "scale",
    "offset",  "word-order", "byte-order", "encoding", "bit",         "byte",
    "text",    "deadband",   "heartbeat",  "limits",   "write"};
constexpr std::string_view kLimits[] = {"low-low",   "low",        "high",
                                        "high-high", "hysteresis", "delay"};
constexpr std::string_view kWrite[] = {"min", "max", "interval"};
constexpr std::string_view kTemplate[] = {"description", "protocols", "defaults",
                                          "options",     "allow",     "channels"};

constexpr Column kColumns[] = {
    {"name", "", "name"},
    {"at", "", "at"},
    {"type", "", "type"},
    {"refresh", "", "refresh"},
    {"mode", "", "mode"},
    {"access", "", "access"},
    {"acquire", "", "acquire"},
    {"priority", "", "priority"},
    {"elasticity", "", "elasticity"},
    {"unit", "", "unit"},
    {"description", "", "description"},
    {"scale", "", "scale"},
    {"offset", "", "offset"},
    {"word-order", "", "word-order"},
    {"byte-order", "", "byte-order"},
    {"encoding", "", "encoding"},
    {"bit", "", "bit"},
    {"byte", "", "byte"},
    {"text", "", "text"},
    {"deadband", "", "deadband"},
    {"heartbeat", "", "heartbeat"},
    {"low-low", "limits", "low-low"},
    {"low", "limits", "low"},
    {"high", "limits", "high"},
    {"high-high", "limits", "high-high"},
    {"hysteresis", "limits", "hysteresis"},
    {"alarm-delay", "limits", "delay"},
    {"write-min", "write", "min"},
    {"write-max", "write", "max"},
    {"write-interval", "write", "interval"},
};

}  // namespace

const KeyTable kBridgeKeys{"bridge", "the configuration", kBridge};
const KeyTable kDdsKeys{"dds", "'dds'", kDds};
const KeyTable kLogKeys{"log", "'log'", kLog};
const KeyTable kProgramKeys{"program", "'program'", kProgram};
const KeyTable kEngineersKeys{"engineers", "'engineers'", kEngineers};
const KeyTable kModulesKeys{"modules", "'modules'", kModules};
const KeyTable kStoreKeys{"store", "'store'", kStore};
const KeyTable kBusKeys{"bus", "a bus", kBus};
const KeyTable kPortKeys{"port", "'port'", kPort};
const KeyTable kBusDefaultKeys{"bus-defaults", "'defaults' of a bus", kBusDefaults};
const KeyTable kDeviceKeys{"device", "a device", kDevice};
const KeyTable kChannelKeys{"channel", "a channel", kChannel};
const KeyTable kLimitKeys{"limits", "'limits'", kLimits};
const KeyTable kWriteKeys{"write", "'write'", kWrite};
const KeyTable kTemplateKeys{"template", "a device template", kTemplate};
const KeyTable kTemplateDefaultKeys{"template-defaults", "'defaults' of a template",
                                    kTemplateDefaults};

std::span<const KeyTable* const> key_tables() {
  static constexpr std::array kTables{
      &kBridgeKeys,  &kDdsKeys,        &kLogKeys,      &kStoreKeys,
      &kProgramKeys, &kEngineersKeys,  &kModulesKeys,  &kBusKeys,
      &kPortKeys,    &kBusDefaultKeys, &kDeviceKeys,   &kChannelKeys,
      &kLimitKeys,   &kWriteKeys,      &kTemplateKeys, &kTemplateDefaultKeys};
  return kTables;
}

std::span<const Column> columns() { return kColumns; }

std::string where_it_belongs(std::string_view key, const KeyTable& here) {
  const auto knows = [&](const KeyTable* table) {
    return std::ranges::find(table->keys, key) != table->keys.end();
  };
  // Nearest first: what a bus lacks is usually in its defaults, what a device lacks in its channels
  // or its bus.
  static constexpr std::array kOrder{&kBusDefaultKeys, &kPortKeys,   &kChannelKeys,   &kDeviceKeys,
                                     &kBusKeys,        &kLimitKeys,  &kWriteKeys,     &kDdsKeys,
                                     &kStoreKeys,      &kBridgeKeys, &kEngineersKeys, &kModulesKeys,
                                     &kTemplateKeys};
  for (const KeyTable* table : kOrder) {
    if (table != &here && knows(table)) return " (it belongs in " + std::string(table->what) + ')';
  }
  return {};
}

}  // namespace fieldcast::config
