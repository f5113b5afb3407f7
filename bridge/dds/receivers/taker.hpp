// A listener that takes the messages of a reader and passes each one with data to a callback, on
// threads of the library.
#pragma once

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

template <class Message>
class Taker : public dds::DataReaderListener {
 public:
  using Take = std::function<void(const Message&, const dds::SampleInfo&)>;
  explicit Taker(Take take) : take_(std::move(take)) {}

 private:
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) take_(message, info);
    }
  }
  const Take take_;
};

}  // namespace fieldcast
