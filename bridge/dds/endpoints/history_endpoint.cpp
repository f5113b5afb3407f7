#include "bridge/dds/endpoints/history_endpoint.hpp"

#include <utility>

namespace fieldcast {

HistoryEndpoint::HistoryEndpoint(Domain& domain, const std::string& label, std::size_t most_bytes,
                                 Received received)
    : domain_(domain),
      most_bytes_(most_bytes),
      taker_([received = std::move(received)](const idl::HistoryRequest& message, const auto&) {
        auto request = from_idl(message);
        if (request) return received(*std::move(request), "");
        received({.requester = message.requester().c_str(),
                  .request_id = message.request_id(),
                  .bus = message.bus().c_str()},
                 request.error());
      }),
      writer_(domain.writer(kHistoryBlockTopic, label)),
      reader_(domain.reader(kHistoryRequestTopic, &taker_, dds::StatusMask::data_available())) {}

void HistoryEndpoint::respond(const HistoryRequest& request, const HistoryResponse& response) {
  to_blocks(request, response, most_bytes_, block_, [this](idl::HistoryBlock& block) {
    if (pace_.is_closed()) return;
    writer_->write(&block);
    if (!block.last()) pace_.rest();
  });
}

void HistoryEndpoint::close() {
  pace_.close();
  if (reader_ != nullptr) domain_.remove(std::exchange(reader_, nullptr));
}

}  // namespace fieldcast
