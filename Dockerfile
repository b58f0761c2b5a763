# One small image for the hub and for every node program:
#   docker build -t fibws . && docker run --rm -p 127.0.0.1:9090:9090 fibws

ARG PYTHON_IMAGE=python:3.13-slim

# It is installed here, into a virtual environment that has no pip;
# whatever building needed stays behind in this stage. That is Node, too, for the hub's page: where
# there is no npm, the build hook asks pip for one.
FROM ${PYTHON_IMAGE} AS build
WORKDIR /src
# First what takes long and seldom changes: the page, which the hook keeps in fibws/hub/page, and
# what fibws depends on. Neither is made anew because a Python file was edited.
COPY pyproject.toml hatch_build.py README.md LICENSE ./
COPY fibws/__init__.py fibws/
COPY web web
RUN python -m venv --without-pip /opt/fibws \
 && pip --python /opt/fibws/bin/python install --no-cache-dir .
COPY . .
RUN pip --python /opt/fibws/bin/python install --no-cache-dir --no-deps --force-reinstall .

FROM ${PYTHON_IMAGE}
# A number rather than a name below, because Kubernetes' runAsNonRoot cannot look names up.
RUN useradd --create-home --uid 10001 fibws
COPY --from=build /opt/fibws /opt/fibws
# Unbuffered, or `docker logs` would see what a program prints only much later.
ENV PATH=/opt/fibws/bin:$PATH \
    PYTHONUNBUFFERED=1
# The base image comes without bytecode, and who is not root can keep none: each program, and each
# check of the hub's health, would compile the standard library anew (0.2 s and more every time).
RUN python -c "import fibws.hub.__main__, fibws.broadcaster, fibws.listener" \
 && python -c "import urllib.request, encodings.idna"
USER 10001
WORKDIR /home/fibws
EXPOSE 9090
# 0.0.0.0 is the container's own network: who may reach it is decided where the port is published.
CMD ["python", "-m", "fibws.hub", "--host", "0.0.0.0"]
