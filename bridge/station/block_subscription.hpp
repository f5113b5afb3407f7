// A station's subscription to SampleBlock and CatalogueBlock: reports channels and samples, and
// requests a snapshot if blocks were lost. DDS only wakes its own thread, which calls the handlers,
// one at a time; a late handler first receives the known state there. Any thread, also a handler of
// another subscription for which that thread waits: no function waits for a handler.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/bus_table.hpp"

namespace fieldcast {

class BlockSubscription : private dds::DataReaderListener {
 public:
  using OnGone = std::function<void(const std::string& bus, const std::string& device,
                                    const std::string& channel)>;

  // `station` is the name in snapshot requests. Throws DdsError.
  BlockSubscription(Domain& domain, std::string station);
  ~BlockSubscription() override;
  BlockSubscription(const BlockSubscription&) = delete;
  BlockSubscription& operator=(const BlockSubscription&) = delete;

  // Call each at most once. Throws DdsError.
  void subscribe_channels(std::function<void(const StationChannel&)> on_channel, OnGone gone);
  void subscribe_samples(std::function<void(const StationSample&)> on_sample, OnGone gone);

  struct Counters {
    std::uint64_t blocks = 0;
    std::uint64_t missing = 0;   // lost blocks: the station was too slow for them
    std::uint64_t requests = 0;  // requests for snapshots
  };
  [[nodiscard]] Counters counters() const;  // up to the last call of a handler

 private:
  // Wait for a snapshot, from its request or the discovery of the bus, before the next request.
  static constexpr Duration kPatience = std::chrono::milliseconds{300};
  // Wait before the first such request to a master with too low numbers; doubles each time.
  static constexpr Duration kBehind = std::chrono::seconds{1},
                            kMostBehind = std::chrono::minutes{1};
  static constexpr std::size_t kMostLost = 4096;  // catalogue blocks

  struct Bus {
    BusTable table;
    Instant due{};  // next request for a snapshot, while one is wanted
    bool wanted = false;
    Instant due_behind{};    // next request, while samples with too low sequence numbers arrive
    Duration rest_behind{};  // zero: no such samples
  };
  struct Known {  // an instance of the catalogue, because its end arrives without keys
    std::string bus;
    std::uint64_t epoch;
    std::uint32_t first;
    idl::CatalogueBlock block;
  };

  // Handlers that the thread installs: either of channels, or of samples with their endpoints.
  struct Addition {
    std::function<void(const StationChannel&)> on_channel;
    std::function<void(const StationSample&)> on_sample;
    OnGone gone;
    dds::DataReader* blocks = nullptr;
    dds::DataWriter* requests = nullptr;
  };

  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void wake();
  void add(Addition addition);
  void run();
  // The next functions and members are used by the thread.
  void install(Addition addition);
  void count();
  [[nodiscard]] std::vector<Known> take_catalogue();  // returns what ended
  void take_blocks();
  void end_of(const dds::InstanceHandle_t& writer);
  void return_of(const dds::InstanceHandle_t& writer);
  void gone(const Known& known);
  Bus& bus_of(const std::string& name);
  void ask_for_snapshots(Instant now);
  [[nodiscard]] static bool is_missing_one(Bus& bus, Instant now);
  [[nodiscard]] static bool is_behind(Bus& bus, Instant now);
  [[nodiscard]] std::optional<Instant> next_request() const;

  BusTable::Handlers handlers_;
  OnGone channel_gone_, sample_gone_;
  std::map<std::string, Bus, std::less<>> buses_;
  // By writer and instance, because two bridges may write one bus.
  std::map<std::pair<dds::InstanceHandle_t, dds::InstanceHandle_t>, Known> known_;
  LostInstances<Known> lost_{kMostLost};
  idl::CatalogueBlock catalogue_block_;
  idl::SampleBlock block_;
  std::uint64_t taken_ = 0, requested_ = 0;  // blocks, snapshots
  dds::DataReader* blocks_ = nullptr;        // null: no subscription to samples
  dds::DataWriter* requests_ = nullptr;

  Domain& domain_;
  const std::string station_;

  // Protects the members below; never held while DDS or a handler is called.
  mutable std::mutex news_mutex_;
  std::condition_variable news_;
  bool fresh_ = false, ending_ = false;
  struct Match {
    dds::InstanceHandle_t writer;  // of the catalogue
    bool came;                     // false: it left
  };
  std::vector<Match> matches_;
  std::vector<Addition> additions_;
  Counters counters_;

  dds::DataReader* catalogue_ = nullptr;
  std::thread thread_;  // last member: it uses the members above
};

}  // namespace fieldcast
