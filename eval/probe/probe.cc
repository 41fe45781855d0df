#include "eval/probe/probe.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "eval/files/suggest.h"
#include "eval/probe/probe_models.h"

namespace alidade {
namespace {

using probe::CaseError;
using probe::Json;

struct Model {
  std::string_view name;
  std::function<Json(const Json&, ErrorConvention)> answer;
};

const std::vector<Model>& Models() {
  static const std::vector<Model> models = {{"pose_only", probe::PoseOnlyAnswer},
                                            {"inverse_depth", probe::InverseDepthAnswer},
                                            {"imu_propagation", probe::ImuPropagationAnswer},
                                            {"preintegration", probe::PreintegrationAnswer},
                                            {"pseudorange", probe::PseudorangeAnswer},
                                            {"doppler", probe::DopplerAnswer}};
  return models;
}

/// JSON has no word for infinity: an answer that holds one is an error, not a null.
bool AllFinite(const Json& value) {
  if (value.is_number_float()) {
    return std::isfinite(value.get<double>());
  }
  if (value.is_structured()) {
    return std::all_of(value.begin(), value.end(), AllFinite);
  }
  return true;
}

Json AnswerCase(const Model& model, const Json& input, ErrorConvention convention) {
  try {
    Json answer = model.answer(input, convention);
    return AllFinite(answer) ? answer : Json{{"error", "the answer is not finite: the case is degenerate"}};
  } catch (const CaseError& error) {
    return Json{{"error", error.message}};
  }
}

}  // namespace

const std::vector<std::string>& ProbeModels() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Model& model : Models()) {
      list.emplace_back(model.name);
    }
    return list;
  }();
  return names;
}

Result<std::string> Probe(std::string_view model_name, const std::string& input, ErrorConvention convention) {
  const auto model = std::find_if(Models().begin(), Models().end(),
                                  [&](const Model& candidate) { return candidate.name == model_name; });
  if (model == Models().end()) {
    return Status::Usage("--model: found \"" + std::string(model_name) + "\"" +
                         Suggestion(model_name, ProbeModels()));
  }
  Json document;
  try {
    document = Json::parse(input);
  } catch (const Json::exception& error) {
    return Status::Input(std::string("not JSON: ") + error.what());
  }
  if (!document.is_object() || !document.contains("cases") || !document["cases"].is_array()) {
    return Status::Input("expected an object {\"cases\": [...]}");
  }
  Json answers = Json::array();
  for (const Json& single : document["cases"]) {
    answers.push_back(AnswerCase(*model, single, convention));
  }
  return Json{{"cases", answers}}.dump(1) + "\n";
}

}  // namespace alidade
