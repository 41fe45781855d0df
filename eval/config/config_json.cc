#include "eval/config/config_json.h"

#include <vector>

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

class JsonWriter final : public ConfigVisitor {
 public:
  explicit JsonWriter(Json* root) : object_(root) {}

  void Section(std::string_view name, std::string_view, const std::function<void()>& keys) override {
    Json* const outer = object_;
    Json section = Json::object();
    object_ = &section;
    keys();
    object_ = outer;
    (*object_)[std::string(name)] = std::move(section);
  }
  void Real(const KeyDoc& doc, double* value, double, double) override { Set(doc, *value); }
  void Integer(const KeyDoc& doc, int* value, int, int) override { Set(doc, *value); }
  void Boolean(const KeyDoc& doc, bool* value) override { Set(doc, *value); }
  void Text(const KeyDoc& doc, std::string* value) override { Set(doc, *value); }
  void Vector3(const KeyDoc& doc, Eigen::Vector3d* value, double, double) override {
    Set(doc, Json::array({value->x(), value->y(), value->z()}));
  }
  void Choice(const KeyDoc& doc, const std::vector<std::string_view>& options, int* index) override {
    Set(doc, std::string(options[static_cast<size_t>(*index)]));
  }

 private:
  void Set(const KeyDoc& doc, Json value) { (*object_)[std::string(doc.name)] = std::move(value); }

  Json* object_;
};

}  // namespace

nlohmann::ordered_json ConfigToJson(const std::function<void(ConfigVisitor&)>& describe) {
  Json root = Json::object();
  JsonWriter writer(&root);
  describe(writer);
  return root;
}

}  // namespace alidade
