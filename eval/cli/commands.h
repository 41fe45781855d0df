#pragma once

#include <string>
#include <vector>

namespace alidade::cli {

// One function a command, each in its own file.
int RunSimulate(const std::vector<std::string>& arguments);
int RunTrack(const std::vector<std::string>& arguments);
int RunRun(const std::vector<std::string>& arguments);
int RunEvaluate(const std::vector<std::string>& arguments);
int RunCompare(const std::vector<std::string>& arguments);
int RunIdentify(const std::vector<std::string>& arguments);
int RunCalibrate(const std::vector<std::string>& arguments);
int RunProbe(const std::vector<std::string>& arguments);
int RunSpp(const std::vector<std::string>& arguments);
int RunStarts(const std::vector<std::string>& arguments);
int RunGnssStudy(const std::vector<std::string>& arguments);
int RunFaultStudy(const std::vector<std::string>& arguments);
int RunAnalyze(const std::vector<std::string>& arguments);
int RunCheck(const std::vector<std::string>& arguments);
int RunConvert(const std::vector<std::string>& arguments);
int RunRefineTruth(const std::vector<std::string>& arguments);
int RunData(const std::vector<std::string>& arguments);
int RunConfig(const std::vector<std::string>& arguments);
int RunManual(const std::vector<std::string>& arguments);
int RunCompletion(const std::vector<std::string>& arguments);

}  // namespace alidade::cli
