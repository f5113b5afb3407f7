// Measures program transmission: `exchange`, `relay` of random bytes, `many` pairings.
#include <CLI/CLI.hpp>
#include <csignal>

#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/program_net.hpp"

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App app{
      "Measures program transmission: each bench starts its own bridge, modules and engineers on "
      "the loopback."};
  app.require_subcommand(1);
  ExchangeOptions exchange;
  auto* exchange_command = app.add_subcommand(
      "exchange", "request and response over a 115200-baud line, with a delay of the network");
  exchange_command->add_option("--bytes", exchange.bytes)->capture_default_str();
  exchange_command->add_option("--delay", exchange.delay_ms, "ms, added to each round trip")
      ->capture_default_str();
  exchange_command->add_flag("--markers", exchange.markers, "marker frames");
  RelayOptions relay;
  auto* relay_command = app.add_subcommand("relay", "random bytes in both directions, compared");
  relay_command->add_option("--gigabytes", relay.gigabytes, "each way")->capture_default_str();
  relay_command->add_flag("--terminal", relay.terminal,
                          "through fieldcast-port and its virtual port too");
  ManyOptions many;
  auto* many_command =
      app.add_subcommand("many", "many modules, half of them programmed, the others collected");
  many_command->add_option("--devices", many.devices)->capture_default_str();
  many_command->add_option("--pairings", many.pairings)->capture_default_str();
  many_command->add_option("--seconds", many.seconds)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return run_bench("program_bench", [&] {
    if (exchange_command->parsed()) exchange_bench(exchange);
    if (relay_command->parsed()) relay_bench(relay);
    if (many_command->parsed()) many_bench(many);
  });
}
