#include "bridge/configure/configuration_agent.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <nlohmann/json.hpp>

#include "bridge/configure/first_values.hpp"
#include "bridge/configure/hidden_secrets.hpp"
#include "bridge/configure/line_scan.hpp"
#include "bridge/configure/protected_keys.hpp"
#include "bridge/log/log.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/pki.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::configure {

namespace {

using Tree = nlohmann::json;

Outcome done(const Json& body) { return {200, body.text()}; }

Outcome refused(unsigned status, const std::string& error, const std::string& hint) {
  return {status, Json{{"error", error}, {"hint", hint}}.text()};
}

// The text of this name; empty if it is missing or too long.
std::optional<std::string> text_in(const Tree& request, const char* name, std::size_t most) {
  const auto found = request.find(name);
  if (found == request.end() || !found->is_string()) return std::nullopt;
  const auto& text = found->get_ref<const std::string&>();
  return text.size() <= most ? std::optional(text) : std::nullopt;
}

std::optional<unsigned> address_in(const Tree& request, const char* name) {
  const std::string text = text_in(request, name, 5).value_or("");
  unsigned address = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), address);
  const bool is_whole = !text.empty() && read.ptr == text.data() + text.size();
  return is_whole && address <= 65535 ? std::optional(address) : std::nullopt;
}

Outcome no_text(const char* name, std::size_t most) {
  return refused(400, fmt::format("{} is missing or too long", name),
                 fmt::format("\"{}\": a text of at most {} bytes", name, most));
}

Outcome unknown_version() {
  return refused(404, "this version is not kept", "GET /api/configuration/versions lists them");
}

Outcome with_faults(const std::vector<config::Fault>& faults) {
  return {400, Json{{"error", "the configuration has faults"},
                    {"hint", "correct the faults"},
                    {"faults", faults_json(faults)}}
                   .text()};
}

std::string remedy_of(const security::SecurityError& error) {
  const auto* file = dynamic_cast<const security::FileError*>(&error);
  if (!file) return {};
  if (file->is_full()) return "free space on the disk of the bridge, and try again";
  if (file->code() == EACCES || file->code() == EPERM || file->code() == EROFS)
    return "the user of the bridge needs the right to write in the folder of the file; for the "
           "packaged service see docs/station.md, 'What the bridge allows'";
  return "an administrator of the bridge's machine checks its disk";
}

// True if two configurations are the same except for the address of the store.
bool differs_only_in_address(BridgeSpec a, const BridgeSpec& b) {
  if (a.store && b.store) a.store->address = b.store->address;
  return a == b;
}

Outcome another_probe() {
  return refused(409, "another engineer reads first values on this bus", "try again");
}

Outcome no_such_bus(const std::string& bus) {
  return refused(409, fmt::format("the bus '{}' does not run on this bridge", printable(bus)),
                 "deploy the bus first, without the new device");
}

constexpr std::size_t kMostVersionBytes = 64, kMostName = 64;
const std::string kSecretPlaces =
    "a hidden password may be in the address of the store and in comments only";
// A station waits longer for a reply.
constexpr Duration kLongestProbe = std::chrono::seconds{8};

}  // namespace

const ConfigurationAgent::Row ConfigurationAgent::kRows[] = {
    {"read", &ConfigurationAgent::read},         {"check", &ConfigurationAgent::check},
    {"deploy", &ConfigurationAgent::deploy},     {"confirm", &ConfigurationAgent::confirm},
    {"rollback", &ConfigurationAgent::rollback}, {"versions", &ConfigurationAgent::versions},
    {"version", &ConfigurationAgent::version},   {"probe", &ConfigurationAgent::probe},
    {"scan", &ConfigurationAgent::scan},
};

ConfigurationAgent::ConfigurationAgent(const std::string& file, Ports ports)
    : folder_(file), ports_(std::move(ports)) {
  watch_ = folder_.stored_watch();
  if (!watch_) return;
  // recover_configuration() has counted this restart.
  watch_->state = Watch::State::kWatching;
  watch_->until = ports_.clock().instant + Watch::kLength;
}

ConfigurationAgent::Response ConfigurationAgent::run(std::string_view request,
                                                     const std::string& subject,
                                                     const Later& later) {
  const Tree parsed = Tree::parse(request, nullptr, false);
  if (!parsed.is_object()) return refused(400, "the request is not a JSON object", "");
  const auto name = text_in(parsed, "operation", 32).value_or("");
  const Row* const row = std::ranges::find(std::begin(kRows), std::end(kRows), name, &Row::name);
  if (row == std::end(kRows))
    return refused(400, fmt::format("the operation '{}' is unknown", printable(name)),
                   "this bridge may be older than the station");
  const std::string user = printable(text_in(parsed, "who", kMostWho).value_or("unknown user"));
  const Caller caller{subject.empty() ? user : fmt::format("{} ({})", user, subject), later};
  try {
    return (this->*row->operation)(parsed, caller);
  } catch (const security::SecurityError& error) {
    return refused(500, printable(error.what()), remedy_of(error));
  }
}

ConfigurationAgent::Response ConfigurationAgent::read(const Tree&, const Caller&) {
  const std::string text = folder_.present();
  const Draft present = load_present(text, folder_.file());
  Json files = Json::array(), lines = Json::array();
  std::size_t bytes = text.size();
  for (const NamedFile& file : present.files) {
    bytes += file.text.size();
    if (bytes > kMostText) break;
    files.push_back({{"name", file.name}, {"text", without_secrets(file.text)}});
  }
  if (present.loaded) {
    for (const ProtectedLine& line : protected_lines(*present.loaded, present.places))
      lines.push_back({{"line", line.line}, {"why", line.why}});
  }
  return done({{"path", folder_.file()},
               {"version", version_of(text)},
               {"text", without_secrets(text)},
               {"files", files},
               {"protected", lines},
               {"watch", watch_json()}});
}

ConfigurationAgent::Response ConfigurationAgent::check(const Tree& request, const Caller&) {
  const auto given = text_in(request, "text", kMostText);
  if (!given) return no_text("text", kMostText);
  const std::string before = folder_.present();
  const Draft present = load_present(before, folder_.file());
  Json faults = Json::array(), plans = Json::array();
  // Without the passwords: a fault or a plan would show one that was moved to another key.
  Draft draft = load_draft(*given, folder_.file(), present.paths, Hopeless::kRefuse);
  if (!draft.loaded) {
    faults = faults_json(draft.loaded.error());
    // A bus that cannot carry its channels is a fault, and its plan explains the remedy.
    draft = load_draft(*given, folder_.file(), present.paths, Hopeless::kAccept);
  }
  if (draft.loaded) plans = plans_json(*draft.loaded);
  const auto text = with_secrets(*given, before);
  const bool is_valid = draft.loaded.has_value();
  bool is_moved = false;
  if (text && *text != *given && is_valid) {
    const BridgeSpec shown = *std::move(draft.loaded);
    draft = load_draft(*text, folder_.file(), present.paths, Hopeless::kAccept);
    is_moved = !draft.loaded || !differs_only_in_address(shown, *draft.loaded);
  }
  if (!text) faults.push_back(fault_json(folder_.file(), text.error(), ""));
  if (is_moved)
    faults.push_back(fault_json(folder_.file(), std::string(kMovedSecret), kSecretPlaces));
  if (text && !is_moved && draft.loaded && present.loaded) {
    for (const std::string& key : changed_protected_keys(*present.loaded, *draft.loaded))
      faults.push_back(
          fault_json(folder_.file(), "a protected key differs: " + key, "restore its lines"));
  }
  return done({{"faults", faults},
               {"draft", plans},
               {"today", present.loaded ? plans_json(*present.loaded) : Json::array()}});
}

ConfigurationAgent::Response ConfigurationAgent::deploy(const Tree& request, const Caller& caller) {
  const auto given = text_in(request, "text", kMostText);
  if (!given) return no_text("text", kMostText);
  const auto base = text_in(request, "base", kMostVersionBytes);
  if (!base) return no_text("base", kMostVersionBytes);
  const auto why = text_in(request, "why", kMostWhy);
  if (!why || why->empty()) return no_text("why", kMostWhy);
  return deploy(*given, *base, *why, caller);
}

Outcome ConfigurationAgent::deploy(const std::string& given, const std::string& base,
                                   const std::string& why, const Caller& caller) {
  const std::string before = folder_.present();
  if (base != version_of(before)) {
    const std::string who = folder_.rows().empty() ? "" : folder_.rows().back().who;
    const std::string by = who.empty() ? "" : ", last by " + who;
    return {409, Json{{"error", "the configuration was changed meanwhile" + by},
                      {"hint", "compare your text with the present one, and deploy again"},
                      {"version", version_of(before)},
                      {"text", without_secrets(before)}}
                     .text()};
  }
  const Draft present = load_present(before, folder_.file());
  const auto text = with_secrets(given, before);
  if (!text) return refused(400, text.error(), "read the configuration again");
  // An earlier version has its passwords and no kHidden. Faults must not show them.
  const bool is_filled = *text != given;
  const std::string shown = is_filled ? given : without_secrets(given);
  Draft draft = load_draft(shown, folder_.file(), present.paths, Hopeless::kRefuse);
  if (!draft.loaded) return with_faults(draft.loaded.error());
  if (*text != shown) {
    const BridgeSpec hidden = *std::move(draft.loaded);
    draft = load_draft(*text, folder_.file(), present.paths, Hopeless::kRefuse);
    // An alias or a moved comment would publish a password, for example as a description.
    if (!draft.loaded || (is_filled && !differs_only_in_address(hidden, *draft.loaded)))
      return refused(400, std::string(kMovedSecret), kSecretPlaces);
  }
  if (!present.loaded)
    return refused(409, "the present file is invalid, so its protected keys are unknown",
                   "an administrator corrects the file itself");
  const auto changed = changed_protected_keys(*present.loaded, *draft.loaded);
  if (!changed.empty())
    return refused(403, fmt::format("a protected key differs: {}", fmt::join(changed, "; ")),
                   "restore its lines");
  return put(*text, printable(why), caller);
}

Outcome ConfigurationAgent::put(const std::string& text, std::string why, const Caller& caller) {
  if (watch_)
    return refused(
        409, fmt::format("the version {} of {} is still watched", watch_->version, watch_->who),
        "confirm it or roll it back first, or wait for the end of the watch");
  const auto qualities = ports_.qualities();
  if (!qualities) return refused(503, "the bridge is starting or reloading", "try again later");
  const UtcMapping now = ports_.clock();
  const std::string before = folder_.present(), base = version_of(before);
  const std::string version = version_of(text);
  if (version == base) return refused(400, "the text does not differ from the file", "");
  if (!folder_.text_of(base))
    folder_.add({base, "", "found in the file", now.utc, "found"}, before);
  folder_.add({version, caller.name, why, now.utc, "watching"}, text);
  watch_ = Watch{.version = version,
                 .base = base,
                 .who = caller.name,
                 .until = now.instant + Watch::kLongestReload,
                 .good = good_channels(*qualities)};
  try {
    folder_.store_watch(watch_);
    folder_.replace(text);
  } catch (const security::SecurityError&) {
    end_watch("not deployed: the file could not be written");
    throw;
  }
  note(caller.name, "deploy", fmt::format("version {}, before {}: {}", version, base, why));
  ports_.reload();
  return done({{"version", version},
               {"until_ms", unix_ms({now.utc.nanoseconds + Watch::kLength.count()})}});
}

ConfigurationAgent::Response ConfigurationAgent::confirm(const Tree& request,
                                                         const Caller& caller) {
  const auto version = text_in(request, "version", kMostVersionBytes);
  if (!version) return no_text("version", kMostVersionBytes);
  if (!watch_ || watch_->version != *version)
    return refused(409, "this version is not watched",
                   "it was kept, confirmed or rolled back already");
  end_watch("confirmed by " + caller.name);
  note(caller.name, "confirm", "version " + *version);
  return done({{"version", *version}});
}

ConfigurationAgent::Response ConfigurationAgent::rollback(const Tree& request,
                                                          const Caller& caller) {
  const auto version = text_in(request, "version", kMostVersionBytes);
  if (!version) return no_text("version", kMostVersionBytes);
  const auto why = text_in(request, "why", kMostWhy);
  if (!why || why->empty()) return no_text("why", kMostWhy);
  if (watch_ && watch_->base == *version) {
    if (!roll_back(printable(*why), caller.name))
      return refused(409, "the file was changed since the deployment, and stays as it is",
                     "read the configuration again");
    return done({{"version", *version}, {"until_ms", nullptr}});
  }
  const auto text = folder_.text_of(*version);
  if (!text) return unknown_version();
  // The rest of the machine may have changed since then.
  return deploy(*text, version_of(folder_.present()),
                fmt::format("back to {}: {}", *version, *why).substr(0, kMostWhy), caller);
}

ConfigurationAgent::Response ConfigurationAgent::versions(const Tree&, const Caller&) {
  Json list = Json::array();
  for (auto row = folder_.rows().rbegin(); row != folder_.rows().rend(); ++row)
    list.push_back({{"version", row->version},
                    {"who", row->who},
                    {"why", row->why},
                    {"at_ms", unix_ms(row->at)},
                    {"state", row->state}});
  return done(list);
}

ConfigurationAgent::Response ConfigurationAgent::version(const Tree& request, const Caller&) {
  const auto version = text_in(request, "version", kMostVersionBytes);
  const auto text = version ? folder_.text_of(*version) : std::nullopt;
  if (!text) return unknown_version();
  return done({{"text", without_secrets(*text)}});
}

ConfigurationAgent::Response ConfigurationAgent::probe(const Tree& request, const Caller& caller) {
  const auto text = text_in(request, "text", kMostText);
  if (!text) return no_text("text", kMostText);
  const std::string bus = text_in(request, "bus", kMostName).value_or("");
  const std::string device = text_in(request, "device", kMostName).value_or("");
  const Draft present = load_present(folder_.present(), folder_.file());
  const Draft draft = load_draft(*text, folder_.file(), present.paths, Hopeless::kAccept);
  if (!draft.loaded) return with_faults(draft.loaded.error());
  const auto found = find_device(*draft.loaded, bus, device);
  if (!found)
    return refused(
        404,
        fmt::format("the text has no device '{}' on a bus '{}'", printable(device), printable(bus)),
        "add the device to the text first");
  note(caller.name, "read first values", fmt::format("of {} on {}", device, bus));
  const bool runs = ports_.probe(
      bus, DeviceProbe({*found}, ports_.clock().instant + kLongestProbe),
      [later = caller.later, spec = *found](const auto& devices, const UtcMapping& clock) {
        later(devices.empty() ? another_probe() : done(first_values_json(spec, devices[0], clock)));
      });
  if (!runs) return no_such_bus(bus);
  return std::nullopt;
}

ConfigurationAgent::Response ConfigurationAgent::scan(const Tree& request, const Caller& caller) {
  const std::string bus = text_in(request, "bus", kMostName).value_or("");
  const std::string protocol = text_in(request, "protocol", kMostName).value_or("");
  const auto first = address_in(request, "first"), last = address_in(request, "last");
  if (!first || !last)
    return refused(400, "first or last is not an address",
                   "two numbers as texts, as \"1\", \"32\"");
  const auto present = load_present(folder_.present(), folder_.file()).loaded;
  if (!present) return with_faults(present.error());
  const auto spec = std::ranges::find(present->buses, bus, &BusSpec::name);
  if (spec == present->buses.end()) return no_such_bus(bus);
  const auto part = scan_part(*spec, protocol, *first, *last);
  if (!part) return refused(400, part.error(), "choose a protocol and addresses of this bus");
  if (part->devices.empty()) return done(scan_json(*part, {}));
  note(caller.name, "scan",
       fmt::format("addresses {} to {} of {} on {}", *first, *last, printable(protocol), bus));
  const bool runs = ports_.probe(
      bus, DeviceProbe(part->devices, ports_.clock().instant + kLongestProbe, part->questions),
      [later = caller.later, part = *part](const auto& devices, const UtcMapping&) {
        later(devices.empty() ? another_probe() : done(scan_json(part, devices)));
      });
  if (!runs) return no_such_bus(bus);
  return std::nullopt;
}

void ConfigurationAgent::reloaded(const std::string& refusal) {
  if (!watch_) return;
  const WatchStep step =
      configure::reloaded(*watch_, without_secrets(refusal), ports_.clock().instant);
  if (step.end == WatchEnd::kRollBack) (void)roll_back(step.reason, "the bridge");
}

void ConfigurationAgent::look() {
  if (folder_.is_unwritten()) {
    try {
      folder_.write();
    } catch (const security::SecurityError&) {}  // end_watch() has logged it
  }
  if (!watch_ || ports_.clock().instant < watch_->until) return;
  const auto qualities = ports_.qualities();
  if (!qualities) return;
  const WatchStep step = looked(*watch_, *qualities, ports_.clock().instant);
  if (step.end == WatchEnd::kRollBack) (void)roll_back(step.reason, "the bridge");
  if (step.end == WatchEnd::kKeep) {
    const std::string version = watch_->version;
    end_watch("kept: " + step.reason);
    note("the bridge", "keep", fmt::format("version {}: {}", version, step.reason));
  }
}

bool ConfigurationAgent::roll_back(const std::string& reason, const std::string& who) {
  const std::string base = watch_->base, version = watch_->version;
  if (version_of(folder_.present()) != version) {
    end_watch("not in force: the file was changed");
    return false;
  }
  folder_.restore(base);
  end_watch(fmt::format("rolled back by {}: {}", who, reason));
  note(who, "rollback", fmt::format("from {} to {}: {}", version, base, reason));
  ports_.reload();
  return true;
}

void ConfigurationAgent::end_watch(std::string state) {
  const std::string version = std::move(watch_->version);
  watch_.reset();
  try {
    folder_.set_state(version, std::move(state));
  } catch (const security::SecurityError& error) {
    log_error("configuration", fmt::format("the watch of the version {} has ended, which is "
                                           "recorded when the disk can be written: {}",
                                           version, error.what()));
  }
  folder_.store_watch(watch_);
}

void ConfigurationAgent::note(const std::string& who, const std::string& what,
                              const std::string& result) {
  ports_.audit({.at = ports_.clock().utc,
                .who = who,
                .what = "configuration: " + what,
                .target = "",
                .result = result});
}

Json ConfigurationAgent::watch_json() const {
  if (!watch_) return nullptr;
  const UtcMapping now = ports_.clock();
  const Duration left = watch_->until - now.instant;
  return {{"version", watch_->version},
          {"base", watch_->base},
          {"until_ms", unix_ms({now.utc.nanoseconds + left.count()})},
          {"state", to_text(watch_->state)}};
}

std::string recover_configuration(const std::string& file) {
  VersionFolder folder(file);
  auto watch = folder.stored_watch();
  if (!watch) {
    if (!folder.rows().empty() && folder.rows().back().state == "watching")
      folder.set_state(folder.rows().back().version, "ended, and the result was not recorded");
    return {};
  }
  const std::string text = folder.present();
  if (version_of(text) != watch->version) {
    // The process ended before the file was replaced, or an administrator has changed it since.
    folder.set_state(watch->version, "not in force: the bridge ended before, or the file changed");
    folder.store_watch(std::nullopt);
    return {};
  }
  const bool is_valid = load_present(text, folder.file()).loaded.has_value();
  const WatchStep step = restarted(*watch, is_valid, Instant{});
  if (step.end != WatchEnd::kRollBack) {
    folder.store_watch(watch);
    return {};
  }
  if (!folder.text_of(watch->base)) return {};
  folder.restore(watch->base);
  folder.store_watch(std::nullopt);
  folder.set_state(watch->version, "rolled back by the bridge: " + step.reason);
  return fmt::format("rolled back from {} to {}: {}", watch->version, watch->base, step.reason);
}

}  // namespace fieldcast::configure
