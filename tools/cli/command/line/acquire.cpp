#include "tools/cli/command/line/acquire.hpp"

#include "core/model/command.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/model/command_text.hpp"

namespace fieldcast::cli {
namespace {

Errand errand_of(const ChannelPath& path, Target target, const std::string& text, std::string type,
                 std::string unit) {
  Errand errand = errand_for(path, Operation::kAcquire, std::move(target), text);
  errand.outcome.type = std::move(type);
  errand.outcome.unit = std::move(unit);
  return errand;
}

// A result names no channels, and each channel may fail separately.
std::vector<Errand> errands_of(const ChannelPath& wanted, const Catalogue& catalogue) {
  std::vector<Errand> errands;
  for (const auto& [path, channel] : catalogue.channels()) {
    const bool meant = path.bus == wanted.bus && path.device == wanted.device &&
                       (wanted.channel.empty() ? channel.access != Access::kWriteOnly
                                               : path.channel == wanted.channel);
    if (meant)
      errands.push_back(
          errand_of(path, ChannelTarget{path.channel}, path.channel, channel.type, channel.unit));
  }
  if (errands.empty()) {
    errands.push_back(
        {{},
         refused_here(wanted, false, Cause::kUnknownChannel, catalogue.explain_unknown(wanted))});
  }
  return errands;
}

// Returns the code of the worst result. Throws DdsError.
ExitCode acquire(const AcquireOptions& options, const Connection& connection, Interrupt& interrupt,
                 const Streams& to) {
  const auto wanted = parse_device_or_channel(options.target);
  if (!wanted) return usage_fault(to.err, "acquire", wanted.error());
  auto type = address_type(options);
  if (!type && !options.type.empty()) return usage_fault(to.err, "acquire", type.error());
  if (!options.at.empty() && !wanted->channel.empty())
    return usage_fault(to.err, "acquire", "with --at name BUS/DEVICE only");

  DomainView domain(connection, interrupt);
  CommandRun run(domain, connection, {options.json, options.timeout}, to);
  const bool raw = !options.at.empty();
  const bool device_alone = raw && type;
  if (!run.learn({*wanted},
                 device_alone ? CommandRun::Wanted::kDevice : CommandRun::Wanted::kChannels))
    return run.why_not();
  if (options.at.empty()) return run.execute(errands_of(*wanted, run.catalogue()));

  std::vector<Errand> errands;
  if (!run.catalogue().has_bus(wanted->bus)) {
    errands.push_back(unknown_bus(*wanted, options.at, false, run.catalogue()));
    return run.execute(std::move(errands));
  }
  if (!type) type = address_type(options, channels_of(run.catalogue(), *wanted));
  if (!type) return usage_fault(to.err, "acquire", type.error());
  errands.push_back(
      errand_of(*wanted, AddressTarget{options.at, type->encoding}, options.at, type->text, {}));
  errands.front().command.command.count = options.count;
  return run.execute(std::move(errands));
}

void describe_acquire(CommandLine& line, AcquireOptions& options) {
  line.text("TARGET", options.target, "BUS/DEVICE or BUS/DEVICE/CHANNEL").required();
  add_command_options(line, options, "Read");
  line.number("--count", options.count, 1, kMaxRawValues,
              "How many values of the type, one behind the other; of a bit the bits from there "
              "on (1)")
      .needs("--at");
}

}  // namespace

CommandRow acquire_command() {
  return command_row("acquire", "Read from a device now", describe_acquire, in_domain(acquire));
}

}  // namespace fieldcast::cli
