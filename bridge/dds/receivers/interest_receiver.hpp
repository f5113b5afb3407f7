// Receives Interest: the channels that stations are interested in, and the end of an interest when
// it is withdrawn or the station crashes. Handlers are called on DDS threads. The default QoS of
// any vendor must match, so the reader requests no lease. A second reader, without samples,
// requests the lease that our stations offer, to detect which of their writers are alive.
#pragma once

#include <atomic>
#include <functional>
#include <map>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class InterestReceiver : private dds::DataReaderListener {
 public:
  // `on_problem`: for the first refused interest, the tenth, the hundredth and so on.
  InterestReceiver(Domain& domain, std::function<void(Interest)> handler,
                   std::function<void(std::string)> on_problem);
  void close();  // no handler is called after it returns

 private:
  void on_data_available(dds::DataReader* reader) override;
  void on_sample_rejected(dds::DataReader* reader,
                          const dds::SampleRejectedStatus& status) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(dds::DataReader* reader,
                             const dds::LivelinessChangedStatus& status) override;

  void end(Interest interest);
  void end_of(const dds::InstanceHandle_t& writer);
  void return_of(const dds::InstanceHandle_t& writer);
  void refuse(const idl::Interest& interest, const std::string& why);
  void refuse(const std::string& text);

  struct Known {
    Interest interest;
    dds::InstanceHandle_t writer;
    bool silent = false;  // its writer is not alive; the interest is restored with the writer
  };

  Domain& domain_;
  std::function<void(Interest)> handler_;
  std::function<void(std::string)> on_problem_;
  std::atomic<std::uint64_t> refused_{0};
  dds::DataReader* reader_ = nullptr;
  dds::DataReader* lease_reader_ = nullptr;
  std::mutex mutex_;  // the reader may be called on any thread of the participant
  // Needed because the end of an interest arrives without its names; at most kMaxInterests.
  std::map<dds::InstanceHandle_t, Known> known_;
  LostInstances<Interest> lost_{static_cast<std::size_t>(kMaxInterests)};
};

}  // namespace fieldcast
