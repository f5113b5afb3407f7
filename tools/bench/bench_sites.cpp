// The messages of many forwarders, published by one process through one connection: each device
// sends one message with a new value of each channel once a second.
//
// usage: bench_sites SERVER SITES DEVICES CHANNELS SECONDS
//
// SERVER: nats://127.0.0.1:PORT. DEVICES of each site, CHANNELS of each device. Creates the
// streams, publishes all catalogues, then samples. Prints "catalogues" and "N messages in S s".
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "bridge/base/clock.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/forward/outlet/nats/nats_options.hpp"
#include "tools/forward/outlet/nats/streams.hpp"
#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::bench {
namespace {

using namespace forward;

constexpr std::int64_t kFlushMs = 30'000;

void check(natsStatus status) {
  if (status == NATS_OK) return;
  std::fprintf(stderr, "bench_sites: %s\n", natsStatus_GetText(status));
  std::exit(1);
}

DeviceCatalogue catalogue_of(const std::string& device, std::size_t channels) {
  DeviceCatalogue catalogue{"line", device, {}};
  for (std::size_t i = 0; i < channels; ++i) {
    StationChannel& channel = catalogue.channels.emplace_back();
    channel.bus = catalogue.bus;
    channel.device = device;
    channel.channel = fmt::format("channel-{}", i);
    channel.type = "float32";
    channel.at = fmt::format("holding:{}", 2 * i);
    channel.refresh = std::chrono::seconds{2};
  }
  return catalogue;
}

SampleBatch batch_of(std::size_t channels, std::uint64_t identity, std::uint64_t epoch,
                     std::uint64_t round, UtcTime now) {
  SampleBatch batch{"line", "", epoch, identity, {}};
  for (std::uint32_t i = 0; i < channels; ++i) {
    const double value = 50 + 20 * std::sin(static_cast<double>(round + i) / 60);
    batch.samples.push_back({i, round, now, static_cast<double>(static_cast<float>(value))});
  }
  return batch;
}

class Sites {
 public:
  Sites(const std::string& server, std::size_t sites, std::size_t devices, std::size_t channels)
      : channels_(channels) {
    spec_.servers = {server};
    spec_.streams.create = true;
    spec_.streams.duplicates = std::chrono::seconds{1};
    spec_.streams.keep = std::chrono::minutes{1};
    auto options = nats_options(spec_, "bench_sites");
    natsConnection* made = nullptr;
    check(options ? natsConnection_Connect(&made, options->get()) : NATS_INVALID_ARG);
    connection_.reset(made);
    jsCtx* context = nullptr;
    check(natsConnection_JetStream(&context, made, nullptr));
    const JetStreamContext owner(context);
    if (const auto created = create_streams(*context, spec_); !created) {
      std::fprintf(stderr, "bench_sites: %s\n", created.error().c_str());
      std::exit(1);
    }
    for (std::size_t site = 0; site < sites; ++site) {
      for (std::size_t device = 0; device < devices; ++device)
        announce(fmt::format("site-{}", site), fmt::format("unit-{}", device));
    }
    check(natsConnection_FlushTimeout(made, kFlushMs));
  }

  [[nodiscard]] std::size_t devices() const { return devices_.size(); }

  void publish(std::size_t device, std::uint64_t round) {
    const auto& [subject, identity] = devices_[device];
    const std::string body =
        encode(batch_of(channels_, identity, epoch_, round, read_clocks().utc));
    check(natsConnection_Publish(connection_.get(), subject.c_str(), body.data(),
                                 static_cast<int>(body.size())));
  }

 private:
  struct Device {
    std::string subject;
    std::uint64_t catalogue;
  };

  void announce(const std::string& site, const std::string& device) {
    const DeviceCatalogue catalogue = catalogue_of(device, channels_);
    const std::uint64_t identity = identity_of(catalogue);
    const std::string body = encode(site, catalogue);
    const std::string key = catalogue_key_of(site, catalogue.bus, device, identity);
    check(natsConnection_Publish(connection_.get(),
                                 fmt::format("$KV.{}.{}", spec_.bucket, key).c_str(), body.data(),
                                 static_cast<int>(body.size())));
    devices_.push_back({fmt::format("fieldcast.{}.line.{}", site, device), identity});
  }

  const std::size_t channels_;
  const std::uint64_t epoch_ = static_cast<std::uint64_t>(read_clocks().utc.nanoseconds);
  JetStreamSpec spec_;
  NatsConnection connection_;
  std::vector<Device> devices_;
};

// The messages of a second are spread over it.
void run(Sites& sites, int seconds) {
  const auto begin = std::chrono::steady_clock::now();
  const auto step = std::chrono::nanoseconds(std::chrono::seconds{1}) /
                    static_cast<std::int64_t>(sites.devices());
  std::uint64_t sent = 0;
  for (int round = 1; round <= seconds; ++round) {
    for (std::size_t device = 0; device < sites.devices(); ++device, ++sent) {
      if (sent % 16 == 0)
        std::this_thread::sleep_until(begin + step * static_cast<std::int64_t>(sent));
      sites.publish(device, static_cast<std::uint64_t>(round));
    }
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::printf("%llu messages in %.1f s\n", static_cast<unsigned long long>(sent), taken.count());
}

}  // namespace
}  // namespace fieldcast::bench

int main(int argc, char** argv) {
  using namespace fieldcast::bench;
  const Arguments arguments(argc, argv);
  if (arguments.size() != 5) {
    std::fprintf(stderr, "usage: bench_sites SERVER SITES DEVICES CHANNELS SECONDS\n");
    return 2;
  }
  Sites sites(arguments.text_at(0), arguments.number_at<std::size_t>(1, 1),
              arguments.number_at<std::size_t>(2, 1), arguments.number_at<std::size_t>(3, 1));
  std::puts("catalogues");
  std::fflush(stdout);
  run(sites, arguments.number_at<int>(4, 10));
}
