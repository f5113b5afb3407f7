#include "tools/cli/arguments.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <sstream>
#include <vector>

#include "core/base/duration_text.hpp"
#include "core/base/near_miss.hpp"
#include "core/model/command.hpp"
#include "tools/cli/clock.hpp"
#include "tools/cli/view/time_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr const char* kExitCodes =
    "exit codes: 0 done, 1 found at fault, 2 usage, 3 no bridge, 4 nothing there, 5 rejected, 6 "
    "failed, 7 expired, 8 no result, "
    "9 trouble, 130 interrupted";

// Texts that become values only after the parse, so that every fault is told in the same way.
struct Texts {
  std::string pattern, time, refresh, timeout, answer, simulate, from, to, role;
  bool once = false;  // of status: its default, which scripts may say aloud
};

void add_connection(CLI::App& command, ConnectionOptions& connection) {
  command
      .add_option("--config", connection.config, "Join the DDS domain of this configuration file")
      ->check(CLI::ExistingFile);
  command.add_option("--domain", connection.domain, "DDS domain (default 0)")
      ->check(CLI::Range(0, 232));
  command.add_option("--interface", connection.interfaces,
                     "IPv4 address that DDS may use (default 127.0.0.1); may be repeated");
}

CLI::App* add_watch(CLI::App& app, WatchOptions& watch, Texts& texts) {
  auto* command = app.add_subcommand("watch", "Show samples: a live table, lines, or JSON lines");
  command->add_option("PATTERN", texts.pattern,
                      "BUS/DEVICE/CHANNEL with *; a shorter one matches all below it");
  command->add_flag("--json", watch.json, "JSON lines");
  command->add_flag("--once", watch.once, "Each matching channel once, then end");
  command->add_option("--for", texts.time,
                      "End after this time (20, 500ms, 2min); with --once the longest wait (10s)");
  command->add_option("--refresh", texts.refresh,
                      "Wish the channels at this refresh while watching");
  add_connection(*command, watch.connection);
  return command;
}

CLI::App* add_write(CLI::App& app, WriteOptions& write, Texts& texts) {
  auto* command = app.add_subcommand("write", "Write values to channels, and wait for the results");
  command
      ->add_option("ASSIGNMENT", write.words,
                   "BUS/DEVICE/CHANNEL=VALUE ..; with --at: BUS/DEVICE VALUE ..")
      ->required();
  command->add_flag("--verify", write.verify, "Read back what was written");
  command->add_option("--at", write.at,
                      "Write to an address of the device, in the PLC's own notation (holding:100)");
  command
      ->add_option(
          "--type", write.type,
          "Type of the values at the address: uint16, float32, string(8), .. (what the address "
          "implies, bool for a coil, or uint16)")
      ->needs("--at");
  command->add_option("--byte", write.byte, "With an 8-bit type: low or high byte of a register")
      ->needs("--at");
  command->add_option("--timeout", texts.timeout,
                      "The command is not started later than this (5s)");
  command->add_flag("--json", write.json, "JSON lines");
  add_connection(*command, write.connection);
  return command;
}

CLI::App* add_acquire(CLI::App& app, AcquireOptions& acquire, Texts& texts) {
  auto* command = app.add_subcommand("acquire", "Read from a device now");
  command->add_option("TARGET", acquire.target, "BUS/DEVICE or BUS/DEVICE/CHANNEL")->required();
  command->add_option("--at", acquire.at,
                      "Read an address of the device, in the PLC's own notation (holding:100)");
  command
      ->add_option(
          "--count", acquire.count,
          "How many values of the type, one behind the other; of a bit the bits from there "
          "on (1)")
      ->check(CLI::Range(1u, kMaxRawValues))
      ->needs("--at");
  command
      ->add_option(
          "--type", acquire.type,
          "Type of the values at the address: uint16, float32, string(8), .. (what the address "
          "implies, bool for a coil, or uint16)")
      ->needs("--at");
  command->add_option("--byte", acquire.byte, "With an 8-bit type: low or high byte of a register")
      ->needs("--at");
  command->add_option("--timeout", texts.timeout,
                      "The command is not started later than this (5s)");
  command->add_flag("--json", acquire.json, "JSON lines");
  add_connection(*command, acquire.connection);
  return command;
}

CLI::App* add_status(CLI::App& app, StatusOptions& status, Texts& texts) {
  auto* command = app.add_subcommand(
      "status", "Show buses and devices: state, load, learned times, failures by cause");
  command->add_flag("--once", texts.once, "Each bus and device once, then end (the default)");
  command->add_option("--for", texts.time, "Follow it for this time (20, 2min)")
      ->excludes("--once");
  command->add_flag("--json", status.json, "JSON lines");
  add_connection(*command, status.connection);
  return command;
}

CLI::App* add_sessions(CLI::App& app, SessionsOptions& sessions, Texts& texts) {
  auto* command = app.add_subcommand("sessions", "Show who programs which device through a bridge");
  command->add_option("--for", texts.time,
                      "Follow them for this time (20, 2min), a line for each report");
  command->add_flag("--json", sessions.json, "JSON lines");
  add_connection(*command, sessions.connection);
  return command;
}

CLI::App* add_plan(CLI::App& app, PlanOptions& plan, Texts& texts) {
  auto* command = app.add_subcommand(
      "plan", "Predict blocks, load and gaps of every bus of a configuration; needs no bridge");
  command->add_option("CONFIG", plan.config, "The configuration file")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--answer", texts.answer,
                      "How long each device is taken to think before it answers (5ms)");
  auto* simulate = command->add_option(
      "--simulate", texts.simulate,
      "Run the whole engine in virtual time for so long (1h) against simulated devices");
  command
      ->add_option("--seed", plan.seed, "Of the simulation: one seed repeats it to the letter (1)")
      ->needs(simulate);
  command
      ->add_option("--faults", plan.faults,
                   "What goes wrong in the simulated plant: a file as fieldcast-sim takes it")
      ->check(CLI::ExistingFile)
      ->needs(simulate);
  command->add_flag("--json", plan.json, "JSON lines");
  return command;
}

CLI::App* add_inspect(CLI::App& app, InspectOptions& inspect) {
  auto* command = app.add_subcommand("inspect", "Explain a frame; needs no bridge");
  command
      ->add_option("PROTOCOL", inspect.protocol,
                   "modbus-rtu, omron-hostlink, .., or a declaration: instrument, ./mine.yaml")
      ->required();
  command->add_option("HEX", inspect.hex,
                      "The frame's bytes; from standard input when there are none");
  command->add_flag("--json", inspect.json, "One JSON object");
  return command;
}

CLI::App* add_sim_check(CLI::App& app, SimCheckOptions& check) {
  auto* command = app.add_subcommand("sim-check",
                                     "Try a protocol's master against its simulated device, "
                                     "through the whole matrix; needs no bridge");
  command
      ->add_option("PROTOCOL", check.protocol,
                   "modbus-rtu, omron-hostlink, .., or a declaration: instrument, ./mine.yaml")
      ->required();
  command->add_flag("--json", check.json, "JSON lines");
  return command;
}

void add_place(CLI::App& command, StorePlace& place) {
  command.add_option("--config", place.config, "Look into the store of this configuration file")
      ->check(CLI::ExistingFile);
  command.add_option("--store", place.store,
                     "Look into this store: a file, or postgresql://USER@HOST/DATABASE");
}

void add_span(CLI::App& command, Texts& texts) {
  command.add_option("--from", texts.from,
                     "2026-11-21T10:30 (UTC), or 2h, 3d for so long ago (1h)");
  command.add_option("--to", texts.to, "The same (now)");
}

CLI::App* add_history(CLI::App& app, HistoryOptions& history, Texts& texts) {
  auto* command =
      app.add_subcommand("history", "Show the stored samples of channels; needs no bridge");
  command
      ->add_option("CHANNEL", texts.pattern,
                   "BUS/DEVICE/CHANNEL with *; a shorter one matches all below it")
      ->required();
  add_span(*command, texts);
  auto* csv = command->add_flag("--csv", history.csv, "Comma-separated values with a head line");
  command->add_flag("--json", history.json, "JSON lines")->excludes(csv);
  add_place(*command, history.place);
  return command;
}

CLI::App* add_devices(CLI::App& app, DevicesOptions& devices) {
  auto* command = app.add_subcommand(
      "devices", "Show the devices that the store knows, and their last state; needs no bridge");
  command->add_flag("--json", devices.json, "JSON lines");
  add_place(*command, devices.place);
  return command;
}

CLI::App* add_audit(CLI::App& app, AuditOptions& audit, Texts& texts) {
  auto* command = app.add_subcommand(
      "audit", "Show who did what: commands, transmissions, logins; needs no bridge");
  add_span(*command, texts);
  command->add_flag("--json", audit.json, "JSON lines");
  add_place(*command, audit.place);
  return command;
}

CLI::App* add_user(CLI::App& app, UserOptions& user, Texts& texts) {
  auto* command =
      app.add_subcommand("user", "Add, list and remove who may log in; needs no bridge");
  command->require_subcommand(1);
  auto* add = command->add_subcommand(
      "add", "Add a user; the password is asked for, or the first line of the standard input");
  add->add_option("NAME", user.name, "Letters, digits, '-', '_', '.', '@'")->required();
  add->add_option("--role", texts.role, "viewer, operator or programmer (viewer)");
  add->add_option("--password-file", user.password_file, "The password is its first line");
  add->callback([&user] { user.action = UserOptions::Action::kAdd; });
  auto* list = command->add_subcommand("list", "List them with their roles");
  list->add_flag("--json", user.json, "JSON lines");
  list->callback([&user] { user.action = UserOptions::Action::kList; });
  auto* remove = command->add_subcommand("remove", "Remove a user");
  remove->add_option("NAME", user.name, "Of the user")->required();
  remove->callback([&user] { user.action = UserOptions::Action::kRemove; });
  for (auto* each : {add, list, remove}) add_place(*each, user.place);
  return command;
}

CLI::App* add_alarms(CLI::App& app, AlarmsOptions& alarms, Texts& texts) {
  auto* command = app.add_subcommand(
      "alarms", "Show the limits that are passed now; with --from, what the store knows");
  add_span(*command, texts);
  command->add_flag("--json", alarms.json, "JSON lines, of those that are clear again too");
  command->add_option("--store", alarms.place.store, "With --from: look into this store");
  add_connection(*command, alarms.connection);
  return command;
}

TimeSpan span_of(const Texts& texts) {
  const UtcTime now = utc_now();
  const auto time = [&](const std::string& text, const char* option, UtcTime otherwise) {
    if (text.empty()) return otherwise;
    const auto parsed = parse_time(text, now);
    if (!parsed) throw CLI::ValidationError(option, parsed.error());
    return *parsed;
  };
  const TimeSpan span{
      time(texts.from, "--from", {now.nanoseconds - Duration(std::chrono::hours{1}).count()}),
      time(texts.to, "--to", now)};
  if (span.to <= span.from)
    throw CLI::ValidationError("--to", "the end is not after the beginning");
  return span;
}

constexpr Duration kLeast = std::chrono::microseconds{1};  // of what must not be 0
constexpr Duration kYear = std::chrono::hours{24 * 365};

// An empty text keeps the default. A number without a unit is seconds, as scripts have it.
template <typename Target>
void set_duration(Target& target, const std::string& text, const char* option,
                  Duration min = kLeast) {
  if (text.empty()) return;
  const auto time = read_duration(text, {min, kYear, true});
  if (!time) throw CLI::ValidationError(option, fault_text(printable(text), time.error()));
  target = *time;
}

// CLI11 would only say that a subcommand is required.
std::optional<NoCommand> unknown_command(const CLI::App& app, std::string_view word) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (word.empty() || word.front() == '-' ||
      std::find(names.begin(), names.end(), word) != names.end())
    return std::nullopt;
  std::string text = "fieldcast: '" + printable(word) + "' is no command; ";
  if (const auto near = near_miss(word, names); !near.empty())
    return NoCommand{ExitCode::kUsage, text + "did you mean " + near + "?\n"};
  text += "there are";
  for (const auto& name : names) text += ' ' + name;
  return NoCommand{ExitCode::kUsage, text + '\n'};
}

}  // namespace

tl::expected<Arguments, NoCommand> parse_arguments(int argc, const char* const* argv) {
  CLI::App app{
      "Fieldcast's command line: samples, commands, state and plans of the buses that "
      "fieldcast-bridge serves.",
      "fieldcast"};
  app.set_version_flag("--version", std::string("fieldcast ") + FIELDCAST_VERSION);
  app.footer(kExitCodes);
  app.require_subcommand(1);

  InspectOptions inspect;
  WatchOptions watch;
  WriteOptions write;
  AcquireOptions acquire;
  StatusOptions status;
  SessionsOptions sessions;
  PlanOptions plan;
  SimCheckOptions check;
  HistoryOptions history;
  DevicesOptions devices;
  AuditOptions audit;
  UserOptions user;
  AlarmsOptions alarms;
  Texts texts;
  const auto* watch_command = add_watch(app, watch, texts);
  const auto* write_command = add_write(app, write, texts);
  const auto* acquire_command = add_acquire(app, acquire, texts);
  const auto* status_command = add_status(app, status, texts);
  const auto* sessions_command = add_sessions(app, sessions, texts);
  const auto* plan_command = add_plan(app, plan, texts);
  const auto* inspect_command = add_inspect(app, inspect);
  const auto* check_command = add_sim_check(app, check);
  const auto* history_command = add_history(app, history, texts);
  const auto* devices_command = add_devices(app, devices);
  const auto* audit_command = add_audit(app, audit, texts);
  const auto* user_command = add_user(app, user, texts);
  const auto* alarms_command = add_alarms(app, alarms, texts);

  if (argc > 1) {
    if (auto fault = unknown_command(app, argv[1])) return tl::unexpected(*std::move(fault));
  }
  try {
    app.parse(argc, argv);
    set_duration(watch.time, texts.time, "--for");
    set_duration(status.time, texts.time, "--for");
    set_duration(sessions.time, texts.time, "--for");
    set_duration(watch.refresh, texts.refresh, "--refresh");
    set_duration(write.timeout, texts.timeout, "--timeout");
    set_duration(acquire.timeout, texts.timeout, "--timeout");
    set_duration(plan.answer_time, texts.answer, "--answer", Duration{});
    set_duration(plan.simulate, texts.simulate, "--simulate");
    auto pattern = Pattern::parse(texts.pattern);
    if (!pattern) throw CLI::ValidationError("PATTERN", pattern.error());
    watch.pattern = history.pattern = *std::move(pattern);
    history.span = audit.span = span_of(texts);
    if (!texts.from.empty() || !texts.to.empty()) alarms.span = history.span;
    alarms.place.config = alarms.connection.config;
    const auto role = role_from(texts.role.empty() ? to_text(user.role) : texts.role);
    if (!role)
      throw CLI::ValidationError(
          "--role", "'" + printable(texts.role) + "' is unknown; viewer, operator or programmer");
    user.role = *role;
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream err;
    const bool asked = app.exit(error, out, err) == 0;  // help and version are "errors" of code 0
    return tl::unexpected(NoCommand{asked ? ExitCode::kOk : ExitCode::kUsage,
                                    asked ? out.str() : "fieldcast: " + err.str()});
  }
  if (watch_command->parsed()) return watch;
  if (write_command->parsed()) return write;
  if (acquire_command->parsed()) return acquire;
  if (status_command->parsed()) return status;
  if (sessions_command->parsed()) return sessions;
  if (plan_command->parsed()) return plan;
  if (inspect_command->parsed()) return inspect;
  if (check_command->parsed()) return check;
  if (history_command->parsed()) return history;
  if (devices_command->parsed()) return devices;
  if (audit_command->parsed()) return audit;
  if (user_command->parsed()) return user;
  if (alarms_command->parsed()) return alarms;
  return tl::unexpected(NoCommand{ExitCode::kUsage, app.help()});
}

}  // namespace fieldcast::cli
