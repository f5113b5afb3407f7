// The bridge's side of HistoryRequest and HistoryBlock. Owns one reader and one writer.
#pragma once

#include <functional>
#include <string>

#include "bridge/dds/endpoints/part_pace.hpp"
#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class HistoryEndpoint {
 public:
  // `fault`: why the request breaks the rules; empty: it does not. Called on DDS threads.
  using Received = std::function<void(HistoryRequest request, std::string fault)>;
  // `most_bytes` of a block. Throws DdsError, for example if this member has no right to the topic.
  HistoryEndpoint(Domain& domain, const std::string& label, std::size_t most_bytes,
                  Received received);
  HistoryEndpoint(const HistoryEndpoint&) = delete;
  HistoryEndpoint& operator=(const HistoryEndpoint&) = delete;

  // Waits between blocks; returns early, without the rest, when close() is called. One thread at a
  // time.
  void respond(const HistoryRequest& request, const HistoryResponse& response);
  void close();  // any thread; nothing is received after it returns

 private:
  Domain& domain_;
  const std::size_t most_bytes_;
  Taker<idl::HistoryRequest> taker_;
  idl::HistoryBlock block_;
  dds::DataWriter* writer_ = nullptr;
  dds::DataReader* reader_ = nullptr;
  PartPace pace_;
};

}  // namespace fieldcast
