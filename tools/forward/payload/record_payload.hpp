// The content of a record of the queue: decoded, or as the payload of a message. Pure; one owner.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "tools/forward/batch/record.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

enum class PayloadFormat : std::uint8_t { kProtobuf, kJson };

struct PayloadSpec {
  PayloadFormat format = PayloadFormat::kProtobuf;
  bool compress = false;  // with zstd; catalogues and alarms stay as they are
  friend bool operator==(const PayloadSpec&, const PayloadSpec&) = default;
};

class RecordDecoder {
 public:
  // `catalogue(identity)` returns the encoded catalogue.
  using FindCatalogue = std::function<std::optional<std::string>(std::uint64_t identity)>;
  explicit RecordDecoder(FindCatalogue catalogue) : catalogue_(std::move(catalogue)) {}

  struct Samples {
    SampleBatch batch;
    const DeviceCatalogue* catalogue;  // valid until the next call
  };
  // Empty if the record cannot be decoded, or its catalogue is missing.
  [[nodiscard]] std::optional<Samples> samples(const Record& record);

 private:
  static constexpr std::size_t kMaxCatalogues = 1024;  // then they are read again

  [[nodiscard]] const DeviceCatalogue* catalogue_of(std::uint64_t identity);

  const FindCatalogue catalogue_;
  std::map<std::uint64_t, DeviceCatalogue> catalogues_;
};

class PayloadMaker {
 public:
  PayloadMaker(std::string site, const PayloadSpec& spec, RecordDecoder::FindCatalogue catalogue)
      : site_(std::move(site)), spec_(spec), decoder_(std::move(catalogue)) {}

  // Empty if the record cannot be decoded, or its catalogue is missing.
  [[nodiscard]] std::optional<std::string> payload_of(const Record& record);

 private:
  [[nodiscard]] std::optional<std::string> json_of(const Record& record);

  const std::string site_;
  const PayloadSpec spec_;
  RecordDecoder decoder_;
};

}  // namespace fieldcast::forward
