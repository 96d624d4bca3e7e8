extern "C" {
#include "pipeline/speak/error.h"
}
#include "findgrains/look/opencv_shim.h"

#include <exception>
#include <new>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

// Run OpenCV and turn everything thrown into an error line. One thread: the caller's loops are the parallel ones.
template <typename Work> static int guarded(const char *what, Work work)
{
    try {
        cv::setNumThreads(1);
        work();
        return 0;
    } catch (const std::bad_alloc &) {
        return error_memory(what);
    } catch (const cv::Exception &exception) {
        if (exception.code == cv::Error::StsNoMem)
            return error_memory(what);
        return error_failed("%s: OpenCV: %s: report this with the photo", what, exception.err.c_str());
    } catch (const std::exception &exception) {
        return error_failed("%s: OpenCV: %s: report this with the photo", what, exception.what());
    } catch (...) {
        return error_failed("%s: OpenCV failed: report this with the photo", what);
    }
}

int shim_resample(const uint16_t *pixels, int stride, int x0, int y0, int width, int height, int out_width,
                  int out_height, float *out)
{
    return guarded("resampling the photo", [&] {
        const uint16_t *first = pixels + (size_t)y0 * (size_t)stride + x0;
        const cv::Mat from(height, width, CV_16U, const_cast<uint16_t *>(first), (size_t)stride * sizeof *pixels);
        cv::Mat to(out_height, out_width, CV_32F, out), resized;
        bool shrinks = out_width <= width;
        cv::resize(from, resized, to.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_CUBIC);
        resized.convertTo(to, CV_32F);
    });
}

int shim_gradient(const float *pixels, int width, int height, float *gx, float *gy)
{
    return guarded("differentiating the photo", [&] {
        const cv::Mat from(height, width, CV_32F, const_cast<float *>(pixels));
        cv::Mat x(height, width, CV_32F, gx), y(height, width, CV_32F, gy);
        cv::Scharr(from, x, CV_32F, 1, 0, 1.0 / 32, 0, cv::BORDER_REPLICATE);
        cv::Scharr(from, y, CV_32F, 0, 1, 1.0 / 32, 0, cv::BORDER_REPLICATE);
    });
}

int shim_sum3(float *pixels, int width, int height)
{
    return guarded("summing votes", [&] {
        cv::Mat image(height, width, CV_32F, pixels);
        cv::boxFilter(image, image, CV_32F, cv::Size(3, 3), cv::Point(-1, -1), false, cv::BORDER_CONSTANT);
    });
}
