#include "eval/comparison/cell_file.h"

#include <nlohmann/json.hpp>
#include <type_traits>

#include "eval/comparison/cell_fields.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

using Json = nlohmann::json;

template <typename T>
concept Plain = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;
template <typename T>
concept Optional = requires(const T& x) {
  x.has_value();
};
template <typename T>
concept Pair = requires(const T& x) {
  x.first;
};
template <typename T>
concept Map = requires {
  typename T::mapped_type;
};
template <typename T>
concept Fixed = requires(const T& x) {
  x.RowsAtCompileTime;
};  // a vector of Eigen
template <typename T>
concept List = requires(T& x) {
  x.push_back(x.front());
}
&&!Plain<T>;

template <typename T>
Json ToJson(const T& x) {
  if constexpr (Plain<T>) {
    return x;
  } else if constexpr (Optional<T>) {
    return x ? ToJson(*x) : Json();
  } else if constexpr (Pair<T>) {
    return Json::array({ToJson(x.first), ToJson(x.second)});
  } else if constexpr (Map<T>) {
    Json object = Json::object();
    for (const auto& [key, value] : x) {
      object[key] = ToJson(value);
    }
    return object;
  } else if constexpr (Fixed<T>) {
    return std::vector<double>(x.data(), x.data() + x.size());
  } else if constexpr (List<T>) {
    Json list = Json::array();
    for (const auto& item : x) {
      list.push_back(ToJson(static_cast<const typename T::value_type&>(item)));
    }
    return list;
  } else {
    Json object = Json::object();
    Fields(x, [&object](const char* name, const auto& value) { object[name] = ToJson(value); });
    return object;
  }
}

/// Throws what nlohmann's access throws when a value is not as expected.
template <typename T>
T FromJson(const Json& json) {
  if constexpr (Plain<T>) {
    return json.get<T>();
  } else if constexpr (Optional<T>) {
    return json.is_null() ? T() : T(FromJson<typename T::value_type>(json));
  } else if constexpr (Pair<T>) {
    return {FromJson<typename T::first_type>(json.at(0)), FromJson<typename T::second_type>(json.at(1))};
  } else if constexpr (Map<T>) {
    T x;
    for (const auto& [key, value] : json.items()) {
      x.emplace(key, FromJson<typename T::mapped_type>(value));
    }
    return x;
  } else if constexpr (Fixed<T>) {
    T x;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      x[i] = json.at(static_cast<size_t>(i)).template get<double>();
    }
    return x;
  } else if constexpr (List<T>) {
    T list;
    for (const Json& item : json) {
      list.push_back(FromJson<typename T::value_type>(item));
    }
    return list;
  } else {
    T x;
    Fields(x, [&json]<typename Value>(const char* name, Value& value) {
      value = FromJson<Value>(json.at(name));
    });
    return x;
  }
}

/// Takes two texts of the object "result" and passes over all else.
class EndReader : public nlohmann::json_sax<Json> {
 public:
  CellEnd end;

  bool key(string_t& name) override {
    key_ = name;
    in_result_ = depth_ == 1 ? name == "result" : in_result_;
    return true;
  }
  bool string(string_t& text) override {
    if (depth_ == 2 && in_result_ && (key_ == "status" || key_ == "message")) {
      (key_ == "status" ? end.status : end.message) = text;
    }
    return true;
  }
  bool start_object(size_t /*size*/) override { return Open(); }
  bool end_object() override { return Close(); }
  bool start_array(size_t /*size*/) override { return Open(); }
  bool end_array() override { return Close(); }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
  bool binary(binary_t& /*value*/) override { return true; }
  bool parse_error(size_t /*at*/, const std::string& /*last*/, const Json::exception& /*error*/) override {
    return false;
  }

 private:
  bool Open() {
    ++depth_;
    return true;
  }
  bool Close() {
    --depth_;
    return true;
  }
  int depth_ = 0;
  bool in_result_ = false;
  std::string key_;
};

}  // namespace

Result<CellEnd> ReadCellEnd(const std::string& path) {
  const Result<std::string> bytes = ReadWholeFile(path);
  ALIDADE_RETURN_IF_ERROR(bytes.status());
  EndReader reader;
  if (!Json::sax_parse(*bytes, &reader, Json::input_format_t::cbor) || reader.end.status.empty()) {
    return Status::Input(path + ": not the result of a cell");
  }
  return std::move(reader.end);
}

Status WriteCellFile(const CellReport& report, const std::string& path) {
  const std::vector<uint8_t> bytes = Json::to_cbor(ToJson(report));
  return WriteFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Result<CellReport> ReadCellFile(const std::string& path) {
  const Result<std::string> bytes = ReadWholeFile(path);
  if (!bytes.ok()) {
    return bytes.status();
  }
  try {
    return FromJson<CellReport>(Json::from_cbor(*bytes));
  } catch (const nlohmann::json::exception& error) {
    return Status::Input(path + ": not the result of a cell: " + error.what());
  }
}

}  // namespace alidade
