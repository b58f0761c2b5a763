# One small image for the hub and for every node program:
#   docker build -t fibws . && docker run --rm -p 127.0.0.1:9090:9090 fibws

ARG PYTHON_IMAGE=python:3.13-slim

# Install into a virtual environment without pip. Everything that only the build needs stays in this
# stage, also Node.js for the hub's page, which the build hook downloads by pip.
FROM ${PYTHON_IMAGE} AS build
WORKDIR /src
# First the slow steps whose input seldom changes: the page, which the hook keeps in fibws/hub/page,
# and the dependencies. Editing a Python file repeats neither.
COPY pyproject.toml hatch_build.py README.md LICENSE ./
COPY fibws/__init__.py fibws/
COPY web web
RUN python -m venv --without-pip /opt/fibws \
 && pip --python /opt/fibws/bin/python install --no-cache-dir .
COPY . .
# Git is not here to tell the version: docker build --build-arg VERSION=0.1.0
ARG VERSION=
RUN SETUPTOOLS_SCM_PRETEND_VERSION=$VERSION \
    pip --python /opt/fibws/bin/python install --no-cache-dir --no-deps --force-reinstall .

FROM ${PYTHON_IMAGE}
# USER below is a number because Kubernetes' runAsNonRoot does not look up names.
# A new volume takes the owner and the mode of the folder that it is mounted on.
RUN useradd --create-home --uid 10001 fibws \
 && install --directory --owner fibws --group fibws --mode 750 \
    /etc/fibws/tokens /etc/fibws/prometheus /var/lib/fibws
COPY --from=build /opt/fibws /opt/fibws
COPY docker/with-node-name /usr/local/bin/
# Unbuffered, so that `docker logs` shows output at once.
ENV PATH=/opt/fibws/bin:$PATH \
    PYTHONUNBUFFERED=1
# The base image has no bytecode, and an unprivileged user cannot write any. Without this step each
# program and each health check would compile the standard library again (0.2 s and more).
RUN python -c "import fibws.hub.__main__, fibws.broadcaster, fibws.listener" \
 && python -c "import urllib.request, encodings.idna"
USER 10001
WORKDIR /home/fibws
EXPOSE 9090
# 0.0.0.0 is the container's own network; publishing the port decides who can reach it.
CMD ["python", "-m", "fibws.hub", "--host", "0.0.0.0"]
