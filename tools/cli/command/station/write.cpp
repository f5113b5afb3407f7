#include "tools/cli/command/station/write.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/model/command_text.hpp"

namespace fieldcast::cli {
namespace {

Errand errand_of(const Assignment& assignment, const Catalogue& catalogue, bool verify) {
  const auto* channel = catalogue.find(assignment.path);
  const auto refused = [&](Cause cause, std::string reason) {
    return Errand{{}, refused_here(assignment.path, true, cause, std::move(reason))};
  };
  if (channel == nullptr)
    return refused(Cause::kUnknownChannel, catalogue.explain_unknown(assignment.path));
  const auto encoding = parse_type(channel->type);
  if (!encoding) return refused(Cause::kUnsupported, encoding.error());
  const auto value = value_from_text(*encoding, assignment.value);
  if (!value) return refused(value.error().cause, value.error().text);

  return channel_write(assignment.path, *value, {channel->type, channel->unit, verify});
}

// If one assignment is refused, none is sent.
void hold_back_if_any_is_refused(std::vector<Errand>& errands) {
  const bool all = std::all_of(errands.begin(), errands.end(),
                               [](const auto& errand) { return errand.to_be_sent(); });
  for (auto& errand : errands) {
    if (all || !errand.to_be_sent()) continue;
    errand.outcome.state = Outcome::State::kNotSent;
    errand.outcome.result.reason = "another of these assignments is refused";
  }
}

ExitCode write_channels(const WriteOptions& options, const Connection& connection,
                        Interrupt& interrupt, const Streams& to) {
  std::vector<Assignment> assignments;
  std::vector<ChannelPath> paths;
  for (const auto& word : options.words) {
    auto assignment = Assignment::parse(word);
    if (!assignment) return usage_fault(to.err, "write", assignment.error());
    paths.push_back(assignment->path);
    assignments.push_back(*std::move(assignment));
  }
  DomainView domain(connection, interrupt);
  CommandRun run(domain, connection, {options.json, options.timeout}, to);
  if (!run.learn(paths)) return run.why_not();
  std::vector<Errand> errands;
  for (const auto& assignment : assignments)
    errands.push_back(errand_of(assignment, run.catalogue(), options.verify));
  hold_back_if_any_is_refused(errands);
  return run.execute(std::move(errands));
}

tl::expected<Errand, std::string> address_errand(const WriteOptions& options,
                                                 const ChannelPath& device,
                                                 const AddressType& type) {
  Errand errand =
      errand_for(device, Operation::kWrite, AddressTarget{options.at, type.encoding}, options.at);
  auto& command = errand.command.command;
  command.verify = options.verify;
  for (auto word = options.words.begin() + 1; word != options.words.end(); ++word) {
    const auto value = value_from_text(type.encoding, *word);
    if (!value) return tl::unexpected(value.error().text);
    command.values.push_back(*value);
  }
  command.count = static_cast<std::uint32_t>(command.values.size());
  errand.outcome.wanted = command.values;
  errand.outcome.type = type.text;
  return errand;
}

ExitCode write_address(const WriteOptions& options, const Connection& connection,
                       Interrupt& interrupt, const Streams& to) {
  const auto device = parse_device_or_channel(options.words.front());
  if (!device || !device->channel.empty())
    return usage_fault(to.err, "write", "with --at write BUS/DEVICE and then the values");
  if (options.words.size() < 2)
    return usage_fault(to.err, "write",
                       fmt::format("no value for {}; write them after BUS/DEVICE", options.at));
  auto type = address_type(options);
  if (!type && !options.type.empty()) return usage_fault(to.err, "write", type.error());
  std::vector<Errand> errands;
  if (type) {
    auto errand = address_errand(options, *device, *type);
    if (!errand) return usage_fault(to.err, "write", errand.error());
    errands.push_back(*std::move(errand));
  }

  DomainView domain(connection, interrupt);
  CommandRun run(domain, connection, {options.json, options.timeout}, to);
  if (!run.learn({*device}, type ? CommandRun::Wanted::kDevice : CommandRun::Wanted::kChannels))
    return run.why_not();
  if (!run.catalogue().has_bus(device->bus)) {
    errands = {unknown_bus(*device, options.at, true, run.catalogue())};
  } else if (errands.empty()) {
    auto errand = address_type(options, channels_of(run.catalogue(), *device))
                      .and_then([&](const AddressType& told) {
                        return address_errand(options, *device, told);
                      });
    if (!errand) return usage_fault(to.err, "write", errand.error());
    errands.push_back(*std::move(errand));
  }
  return run.execute(std::move(errands));
}

// Returns the worst code. Sends nothing if an assignment is refused locally. Throws DdsError.
ExitCode write(const WriteOptions& options, const Connection& connection, Interrupt& interrupt,
               const Streams& to) {
  return options.at.empty() ? write_channels(options, connection, interrupt, to)
                            : write_address(options, connection, interrupt, to);
}

void describe_write(CommandLine& line, WriteOptions& options) {
  line.texts("ASSIGNMENT", options.words,
             "BUS/DEVICE/CHANNEL=VALUE ..; with --at: BUS/DEVICE VALUE ..")
      .required();
  line.flag("--verify", options.verify, "Read back what was written");
  add_command_options(line, options, "Write to");
}

}  // namespace

CommandRow write_command() {
  return command_row("write", "Write values to channels, and wait for the results", describe_write,
                     in_domain(write));
}

}  // namespace fieldcast::cli
