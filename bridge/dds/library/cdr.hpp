// Reads and writes message bytes with Fast CDR, for types without generated code. Hides the names
// that differ between Fast CDR 1 and 2. Objects do not own the bytes. One thread at a time.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/BadParamException.h>
#include <fastcdr/exceptions/NotEnoughMemoryException.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

// Whether a string without its final zero is refused: from_bytes() of 3.x compares sizes.
inline constexpr bool kStringsEndWithZero = FASTDDS_VERSION_MAJOR >= 3;

// Writes the content of a message after its encapsulation, in the byte order of this machine or in
// the opposite order. Throws NotEnoughMemoryException of Fast CDR.
class CdrWriter {
 public:
  CdrWriter(void* space, std::size_t size, bool in_own_order = true)
      : buffer_(static_cast<char*>(space), size),
#if FASTDDS_VERSION_MAJOR >= 3
        cdr_(buffer_, order(in_own_order), eprosima::fastcdr::CdrVersion::XCDRv1) {
    cdr_.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
#else
        cdr_(buffer_, order(in_own_order), Cdr::DDS_CDR) {
#endif
    cdr_.serialize_encapsulation();
  }

  template <class Value>
  CdrWriter& operator<<(const Value& value) {
    cdr_ << value;
    return *this;
  }
  template <class Message>
  void add_keys(const Message& message) {
#if FASTDDS_VERSION_MAJOR >= 3
    serialize_key(cdr_, message);
#else
    message.serializeKey(cdr_);
#endif
  }
  // Adds the bytes unchanged. Returns false if there is no space.
  [[nodiscard]] bool add_bytes(std::string_view bytes) {
#if FASTDDS_VERSION_MAJOR >= 3
    char* const behind = cdr_.get_current_position();
#else
    char* const behind = cdr_.getCurrentPosition();
#endif
    if (!cdr_.jump(bytes.size())) return false;
    std::memcpy(behind, bytes.data(), bytes.size());
    return true;
  }
  [[nodiscard]] std::size_t size() const {
#if FASTDDS_VERSION_MAJOR >= 3
    return cdr_.get_serialized_data_length();
#else
    return cdr_.getSerializedDataLength();
#endif
  }
  [[nodiscard]] std::uint16_t encapsulation() const {
    return cdr_.endianness() == Cdr::BIG_ENDIANNESS ? CDR_BE : CDR_LE;
  }

 private:
  using Cdr = eprosima::fastcdr::Cdr;
  static Cdr::Endianness order(bool own) {
    return own == (Cdr::DEFAULT_ENDIAN == Cdr::LITTLE_ENDIANNESS) ? Cdr::LITTLE_ENDIANNESS
                                                                  : Cdr::BIG_ENDIANNESS;
  }
  eprosima::fastcdr::FastBuffer buffer_;
  Cdr cdr_;
};
using CdrFull = eprosima::fastcdr::exception::NotEnoughMemoryException;

// Reads the content of a message after its encapsulation, in its byte order. Every function throws
// an exception of Fast CDR, a std::exception, if the bytes end too early.
class CdrReader {
 public:
  CdrReader(const void* bytes, std::size_t size)
      : begin_(static_cast<const char*>(bytes)),
        size_(size),
        buffer_(const_cast<char*>(begin_), size),  // which is read only
#if FASTDDS_VERSION_MAJOR >= 3
        cdr_(buffer_, Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::CdrVersion::XCDRv1) {
    if (!is_first_representation(bytes, size))
      throw eprosima::fastcdr::exception::BadParamException("not the first representation");
#else
        cdr_(buffer_, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR) {
#endif
    cdr_.read_encapsulation();
  }

  template <class Value>
  CdrReader& operator>>(Value& value) {
    cdr_ >> value;
    return *this;
  }
  // Reads a string up to its first NUL; returns a view of the bytes.
  [[nodiscard]] std::string_view text() {
    std::uint32_t length = 0;
    cdr_ >> length;
    const char* const text = begin_ + size();
    if (length > size_ - size())
      throw eprosima::fastcdr::exception::NotEnoughMemoryException("a string ends behind the end");
    // Fast CDR aligns the next value by the size of the last value read, and ignores a jump. So the
    // last byte is read.
    char last = 0;
    if (length > 0 && cdr_.jump(length - 1)) cdr_ >> last;
    if (kStringsEndWithZero && (length == 0 || last != 0))
      throw eprosima::fastcdr::exception::BadParamException("a string has no final zero");
    const std::string_view whole(text, length);
    return whole.substr(0, whole.find('\0'));
  }
  // Bytes read so far, including the encapsulation.
  [[nodiscard]] std::size_t size() const {
#if FASTDDS_VERSION_MAJOR >= 3
    return static_cast<std::size_t>(const_cast<Cdr&>(cdr_).get_current_position() - begin_);
#else
    return static_cast<std::size_t>(const_cast<Cdr&>(cdr_).getCurrentPosition() - begin_);
#endif
  }
  // Returns true if the message has the byte order of this machine.
  [[nodiscard]] bool is_native() const { return cdr_.endianness() == Cdr::DEFAULT_ENDIAN; }

 private:
  using Cdr = eprosima::fastcdr::Cdr;
  const char* const begin_;
  const std::size_t size_;
  eprosima::fastcdr::FastBuffer buffer_;
  Cdr cdr_;
};

}  // namespace fieldcast
