#include "tools/cli/command/line/acquire.hpp"

#include <ostream>

#include "core/model/command.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/model/command_text.hpp"

namespace fieldcast::cli {
namespace {

ExitCode usage(std::ostream& err, const std::string& fault) {
  err << "fieldcast acquire: " << fault << '\n';
  return ExitCode::kUsage;
}

Errand errand_of(const ChannelPath& path, Target target, std::string text, std::string type,
                 std::string unit) {
  Errand errand;
  errand.command.bus = path.bus;
  errand.command.command.device = path.device;
  errand.command.command.target = std::move(target);
  errand.command.command.operation = Operation::kAcquire;
  errand.outcome.bus = path.bus;
  errand.outcome.device = path.device;
  errand.outcome.target = std::move(text);
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

}  // namespace

ExitCode acquire(const AcquireOptions& options, const Connection& connection, Interrupt& interrupt,
                 std::ostream& out, std::ostream& err) {
  const auto wanted = parse_device_or_channel(options.target);
  if (!wanted) return usage(err, wanted.error());
  auto type = address_type(options);
  if (!type && !options.type.empty()) return usage(err, type.error());
  if (!options.at.empty() && !wanted->channel.empty())
    return usage(err, "with --at name BUS/DEVICE only");

  DomainView domain(connection, interrupt);
  CommandRun run(domain, connection, {options.json, options.timeout}, out, err);
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
  if (!type) return usage(err, type.error());
  errands.push_back(
      errand_of(*wanted, AddressTarget{options.at, type->encoding}, options.at, type->text, {}));
  errands.front().command.command.count = options.count;
  return run.execute(std::move(errands));
}

namespace {

class AcquireCommand final : public CommandWith<AcquireOptions> {
 public:
  void describe(CommandLine& line) override {
    line.text("TARGET", options_.target, "BUS/DEVICE or BUS/DEVICE/CHANNEL").required();
    add_command_options(line, options_, "Read");
    line.number("--count", options_.count, 1, kMaxRawValues,
                "How many values of the type, one behind the other; of a bit the bits from there "
                "on (1)")
        .needs("--at");
  }
  ExitCode run(const Streams& streams) override {
    return in_domain(options_.connection, streams,
                     [&](const Connection& connection, Interrupt& interrupt) {
                       return acquire(options_, connection, interrupt, streams.out, streams.err);
                     });
  }
};

}  // namespace

CommandEntry acquire_command();
CommandEntry acquire_command() {
  return {"acquire", "Read from a device now", make_command<AcquireCommand>};
}

}  // namespace fieldcast::cli
